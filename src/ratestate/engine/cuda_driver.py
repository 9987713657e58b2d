"""Call NVIDIA's driver by ctypes, without its toolkit or another package."""

import ctypes
import functools

#: attributes of a GPU, as the driver numbers them
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


def query(kind, name, *arguments):
    """Call a function of the driver that writes a result, a C type, and return it."""
    value = kind()
    call(name, ctypes.byref(value), *arguments)
    return value


@functools.cache
def device():
    """Initialize the driver, return the first GPU; CudaError or OSError without one."""
    call("cuInit", 0)
    return query(ctypes.c_int, "cuDeviceGet", 0)


def attribute(number):
    return query(ctypes.c_int, "cuDeviceGetAttribute", number, device()).value


def gpu_name():
    """Return the GPU's name and compute capability."""
    name = ctypes.create_string_buffer(256)
    call("cuDeviceGetName", name, 256, device())
    return f"{name.value.decode()}, compute capability {attribute(MAJOR)}.{attribute(MINOR)}"


@functools.cache
def _context():
    return query(ctypes.c_void_p, "cuDevicePrimaryCtxRetain", device())


def enter():
    """Make the GPU current for the calling thread."""
    call("cuCtxSetCurrent", _context())


@functools.cache
def function(image):
    """Assemble PTX, bytes, for the GPU and return its function "kernel"."""
    module = query(ctypes.c_void_p, "cuModuleLoadData", image)
    return query(ctypes.c_void_p, "cuModuleGetFunction", module, b"kernel")


def launch(kernel, blocks, threads, *arguments):
    """Launch a kernel; arguments : C types."""
    places = (ctypes.c_void_p * len(arguments))(*map(ctypes.addressof, arguments))
    call("cuLaunchKernel", kernel, blocks, 1, 1, threads, 1, 1, 0, None, places, None)


class Memory:
    """Copies of NumPy arrays in the GPU's memory."""

    def __init__(self):
        self._copies = {}  # id of an array -> its address on the GPU, and the array

    def address(self, array):
        """Return the address of an array on the GPU; copy it there the first time."""
        if id(array) not in self._copies:
            size = ctypes.c_size_t(max(1, array.nbytes))  # the driver refuses 0
            self._copies[id(array)] = query(ctypes.c_uint64, "cuMemAlloc_v2", size), array
            self.send(array)
        return self._copies[id(array)][0].value

    def send(self, array):
        self._copy("cuMemcpyHtoD_v2", array, 1)

    def fetch(self, array):
        self._copy("cuMemcpyDtoH_v2", array, -1)

    def _copy(self, name, array, order):
        pair = self._copies[id(array)][0], ctypes.c_void_p(array.ctypes.data)
        if array.nbytes > 0:
            call(name, *pair[::order], ctypes.c_size_t(array.nbytes))

    def free(self):
        """Free the memory, also after an error."""
        for address, _ in self._copies.values():
            library().cuMemFree_v2(address)
