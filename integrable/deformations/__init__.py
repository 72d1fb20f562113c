"""The tilde, check, hat and gyroscopic pairs, which deform the ball and the top: integrals, steps and motions."""
