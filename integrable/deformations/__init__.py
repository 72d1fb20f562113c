"""The tilde, check, hat and gyroscopic pairs: their integrals, steps and motions."""
