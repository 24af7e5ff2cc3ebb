"""The one buffer of a glTF file, with its views and accessors, as the scripts that make scenes fill it."""

import base64
import struct

COMPONENTS = {"f": 5126, "H": 5123, "I": 5125}
COUNTS = {"SCALAR": 1, "VEC3": 3, "VEC4": 4, "MAT4": 16}


class GltfBuffer:
    def __init__(self, views=(), accessors=(), number=0):
        self.data, self.views, self.accessors, self.number = b"", list(views), list(accessors), number

    def add(self, values, component, kind, has_bounds=False, **view):
        """Appends numbers (or rows of them) as a view of its own with one accessor, and returns the accessor's number."""
        values = [number for row in values for number in (row if isinstance(row, (list, tuple)) else [row])]
        form, size = f"<{len(values)}{component}", COUNTS[kind]
        payload = struct.pack(form, *values)
        accessor = {"componentType": COMPONENTS[component], "type": kind, "count": len(values) // size}
        if has_bounds:
            columns = [struct.unpack(form, payload)[k::size] for k in range(size)]
            accessor |= {"min": [min(column) for column in columns], "max": [max(column) for column in columns]}
        self.views.append({"buffer": self.number, "byteOffset": len(self.data), "byteLength": len(payload), **view})
        self.accessors.append({"bufferView": len(self.views) - 1, **accessor})
        self.data += payload + b"\0" * (-len(payload) % 4)
        return len(self.accessors) - 1

    def describe(self):
        """Returns the buffer as the file has it."""
        uri = "data:application/octet-stream;base64," + base64.b64encode(self.data).decode()
        return {"byteLength": len(self.data), "uri": uri}
