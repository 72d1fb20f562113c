"""What a motion is, beside its states: frequencies, actions, diagrams, sections, sensitivities."""
