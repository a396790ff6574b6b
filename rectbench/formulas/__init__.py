"""One formula for NumPy arrays, Dr.Jit arrays and derivatives; monotone functions and their inverses."""
