"""Systems of many degrees of freedom that move on Jacobians of any genus, one file each."""
