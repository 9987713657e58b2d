"""Calls of NVIDIA's driver by ctypes.  Neither a toolkit nor another package is needed."""

import ctypes
import functools

#: the driver's numbers for attributes of a GPU
MULTIPROCESSORS, MAJOR, MINOR = 16, 75, 76


class CudaError(Exception):
    """A function of the driver failed."""


@functools.cache
def library():
    """Load the driver's library; OSError if there is none."""
    return ctypes.CDLL("libcuda.so.1")


def call(name, *arguments):
    """Call a function of the driver; CudaError if it fails."""
    if code := getattr(library(), name)(*arguments):
        text = ctypes.c_char_p()
        library().cuGetErrorString(code, ctypes.byref(text))
        raise CudaError(f"{name}: {(text.value or b'unknown error').decode()}")


def found(kind, name, *arguments):
    """Call a function of the driver and return its result, a C type, from its first argument."""
    value = kind()
    call(name, ctypes.byref(value), *arguments)
    return value


@functools.cache
def device():
    """Initialize the driver and return the first GPU; CudaError or OSError if there is none."""
    call("cuInit", 0)
    return found(ctypes.c_int, "cuDeviceGet", 0)


def attribute(number):
    """Return an attribute of the GPU, an int."""
    return found(ctypes.c_int, "cuDeviceGetAttribute", number, device()).value


def gpu_name():
    """Return the GPU's name and compute capability."""
    name = ctypes.create_string_buffer(256)
    call("cuDeviceGetName", name, 256, device())
    return f"{name.value.decode()}, compute capability {attribute(MAJOR)}.{attribute(MINOR)}"


@functools.cache
def _context():
    return found(ctypes.c_void_p, "cuDevicePrimaryCtxRetain", device())


def enter():
    """Let the calling Python thread use the GPU."""
    call("cuCtxSetCurrent", _context())


@functools.cache
def function(image):
    """Assemble PTX, bytes, for the GPU and return its function "kernel"."""
    module = found(ctypes.c_void_p, "cuModuleLoadData", image)
    return found(ctypes.c_void_p, "cuModuleGetFunction", module, b"kernel")


def launch(kernel, blocks, threads, *arguments):
    """Launch a kernel; arguments : C types."""
    places = (ctypes.c_void_p * len(arguments))(*map(ctypes.addressof, arguments))
    call("cuLaunchKernel", kernel, blocks, 1, 1, threads, 1, 1, 0, None, places, None)


class Memory:
    """Copies of NumPy arrays in the GPU's memory."""

    def __init__(self):
        self._places = {}  # id of an array -> its address on the GPU, and the array

    def place(self, array):
        """Return the address of an array on the GPU, after copying it there the first time."""
        if id(array) not in self._places:
            size = ctypes.c_size_t(max(1, array.nbytes))  # (the driver refuses 0)
            self._places[id(array)] = found(ctypes.c_uint64, "cuMemAlloc_v2", size), array
            self.send(array)
        return self._places[id(array)][0].value

    def send(self, array):
        """Copy an array to the GPU."""
        self._copy("cuMemcpyHtoD_v2", array, 1)

    def fetch(self, array):
        """Copy an array from the GPU, after all launches have ended."""
        self._copy("cuMemcpyDtoH_v2", array, -1)

    def _copy(self, name, array, order):
        pair = self._places[id(array)][0], ctypes.c_void_p(array.ctypes.data)
        if array.nbytes > 0:
            call(name, *pair[::order], ctypes.c_size_t(array.nbytes))

    def free(self):
        """Free the memory, also after an error."""
        for place, _ in self._places.values():
            library().cuMemFree_v2(place)
