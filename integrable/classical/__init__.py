"""Systems with many degrees of freedom whose motions are linear on Jacobians of any genus, one file each."""
