"""Classical systems whose motions are linear on Jacobians."""
