"""Numbers of code that is being compiled: their arithmetic writes LLVM instructions.

A long straight line of arithmetic is compiled so in a fraction of the time that numba takes to
read it as Python.  It is that of functions compiled with contraction (jit.py).
"""

from llvmlite import ir

FLAGS = ("contract",)


class LLVMNumber:
    """A double in a function that a builder of llvmlite writes; an operand may be a float."""

    def __init__(self, builder, value):
        self.builder = builder
        self.value = value if isinstance(value, ir.Value) else ir.Constant(ir.DoubleType(), value)

    def _write(self, instruction, x, y):
        x, y = (one if isinstance(one, LLVMNumber) else LLVMNumber(self.builder, one) for one in (x, y))
        return LLVMNumber(self.builder, getattr(self.builder, instruction)(x.value, y.value, flags=FLAGS))

    def __add__(self, other):
        return self._write("fadd", self, other)

    def __radd__(self, other):
        return self._write("fadd", other, self)

    def __sub__(self, other):
        return self._write("fsub", self, other)

    def __rsub__(self, other):
        return self._write("fsub", other, self)

    def __mul__(self, other):
        return self._write("fmul", self, other)

    def __rmul__(self, other):
        return self._write("fmul", other, self)

    def __truediv__(self, other):
        return self._write("fdiv", self, other)

    def __rtruediv__(self, other):
        return self._write("fdiv", other, self)

    def __neg__(self):
        return self._write("fsub", -0.0, self)
