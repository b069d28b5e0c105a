"""Which files of a mesh's folder may be sent."""

import io
import pathlib
import tempfile
import unittest

from curvecast.mesh import find_companion, may_have_companions, mesh_id_of


class MeshTest(unittest.TestCase):
    def setUp(self) -> None:
        root = tempfile.TemporaryDirectory()
        self.addCleanup(root.cleanup)
        self.outside = pathlib.Path(root.name)
        self.folder = self.outside / "mesh"
        (self.folder / "textures").mkdir(parents=True)
        for name in ("mesh/a.obj", "mesh/a.mtl", "mesh/textures/a.png", "mesh/.hidden.png", "mesh/secret.txt", "secret.png"):
            (self.outside / name).write_text("something")
        self.mesh = self.folder / "a.obj"

    def test_files_of_the_folder(self) -> None:
        self.assertEqual(find_companion(self.mesh, "a.mtl"), self.folder.resolve() / "a.mtl")
        self.assertEqual(find_companion(self.mesh, "textures/a.png"), self.folder.resolve() / "textures" / "a.png")
        self.assertIsNone(find_companion(self.mesh, "b.mtl"))
        (self.folder / "empty.mtl").touch()
        self.assertIsNone(find_companion(self.mesh, "empty.mtl"))

    def test_no_others(self) -> None:
        (self.folder / "link.png").symlink_to(self.outside / "secret.png")
        (self.folder / "loop.png").symlink_to(self.folder / "loop.png")
        names = [
            "../secret.png",
            "textures/../../secret.png",
            str(self.outside / "secret.png"),
            ".hidden.png",
            "secret.txt",
            "",
            "a\0.png",
            "textures//a.png",
            "./a.mtl",
            "link.png",
        ]
        for name in names:
            with self.subTest(name), self.assertRaises(ValueError):
                find_companion(self.mesh, name)
        self.assertIsNone(find_companion(self.mesh, "loop.png"))
        (self.folder / "inside.png").symlink_to(self.folder / "textures" / "a.png")
        self.assertIsNotNone(find_companion(self.mesh, "inside.png"))

    def test_formats_that_refer_to_others(self) -> None:
        for name, refers in (("a.OBJ", True), ("a.gltf", True), ("a.glb", True), ("a.ply", True), ("a.off", False), ("obj", False)):
            self.assertEqual(may_have_companions(pathlib.Path(name)), refers, name)

    def test_ids_are_hashes_of_bytes(self) -> None:
        self.assertEqual(mesh_id_of(io.BytesIO(b"")), "e3b0c44298fc1c149afbf4c8996fb924")  # sha256sum of nothing
        self.assertEqual(mesh_id_of(io.BytesIO(b"abc")), "ba7816bf8f01cfea414140de5dae2223")  # printf abc | sha256sum


if __name__ == "__main__":
    unittest.main()
