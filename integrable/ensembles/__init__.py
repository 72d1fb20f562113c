"""Many motions at once: one system, many bodies and states, each as its own flow has it."""
