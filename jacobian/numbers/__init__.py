"""The number types under compiled code: words, tables of small fields, double-doubles, long reals."""
