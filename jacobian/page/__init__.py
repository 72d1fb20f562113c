"""What is known of a curve over QQ, on one page."""
