"""Large robots: their equations as loops over bodies, compiled once for a tree of any size."""

from cutpoint.rolled.functions import RECIPES, RolledFunction, rolled_function

__all__ = ["RECIPES", "RolledFunction", "rolled_function"]
