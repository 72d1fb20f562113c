"""From a start to the states at physical times, near and far, in floats and to any digits, with proven bounds."""
