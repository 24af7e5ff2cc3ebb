"""The one buffer of a glTF file, with its views and accessors, as the scripts that make scenes fill it."""

import base64


class GltfBuffer:
    def __init__(self, views=(), accessors=(), number=0):
        self.data, self.views, self.accessors, self.number = b"", list(views), list(accessors), number

    def add(self, payload, accessor, **view):
        """Appends `payload` as a view of its own with one accessor, and returns the accessor's number."""
        self.views.append({"buffer": self.number, "byteOffset": len(self.data), "byteLength": len(payload), **view})
        self.accessors.append({"bufferView": len(self.views) - 1, **accessor})
        self.data += payload + b"\0" * (-len(payload) % 4)
        return len(self.accessors) - 1

    def describe(self):
        """Returns the buffer as the file has it."""
        uri = "data:application/octet-stream;base64," + base64.b64encode(self.data).decode()
        return {"byteLength": len(self.data), "uri": uri}
