"""Classical systems whose motions are linear on Jacobians, one file for each."""
