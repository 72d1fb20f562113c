"""Groups on a curve besides its Jacobian: signed pairs, generalized Jacobians, ray classes, the conic Picard group."""
