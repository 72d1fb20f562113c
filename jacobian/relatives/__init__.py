"""The other groups on a curve: signed pairs, generalized Jacobians, ray classes, the conic Picard group."""
