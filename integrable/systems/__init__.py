"""The Chaplygin ball and the Euler top."""
