"""The shape of a motion: frequencies, actions, diagrams, sections, sensitivities."""
