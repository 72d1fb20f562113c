"""What compiled code and long numbers are made of: words, tables of small fields, double-doubles, long reals."""
