"""How each scheme converges to exact solutions: observed order and error."""
