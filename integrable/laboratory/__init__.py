"""Bodies as a laboratory has them: tensors in any axes, orientations, angular velocities, metres and seconds."""
