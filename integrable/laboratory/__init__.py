"""Bodies in the laboratory: tensors in any axes, orientations, angular velocities, metres and seconds."""
