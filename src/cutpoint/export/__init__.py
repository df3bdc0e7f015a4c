"""Export: robots' functions and control laws as C99, equal to machine code to the last bit; functions as CUDA C too."""

from cutpoint.export.packages import export_controller, export_function

__all__ = ["export_controller", "export_function"]
