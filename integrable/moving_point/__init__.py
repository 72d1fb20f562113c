"""The divisor in motion: its curve and start, translations along the flow, and the loops that carry it."""
