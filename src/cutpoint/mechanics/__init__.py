"""The equations, on scalars of any kind.  Begin with `inverse_dynamics`; each function cites its equations."""
