"""A small compiler for numeric Python loops. It supports only the statements and kinds of numbers that these loops
need.
"""
