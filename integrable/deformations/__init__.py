"""Steps and motions of the tilde, check, hat and gyroscopic pairs of integrals, which deform the ball and the top."""
