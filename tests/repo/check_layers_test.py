"""scripts/check_layers.py finds what it should: one broken include of each kind, in a tree of its own."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

TOP = pathlib.Path(__file__).resolve().parents[2]


def complaints(files):
    with tempfile.TemporaryDirectory() as root:
        for name, text in files.items():
            path = pathlib.Path(root, name)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        run = subprocess.run([sys.executable, TOP / "scripts/check_layers.py", "--root", root],
                             capture_output=True, text=True, check=False)
        lines = [line for line in run.stderr.splitlines() if not line.startswith("check_layers.py:")]
        assert (run.returncode == 0) == (not lines), run.stderr
        return lines


# Headers that the includes below name.
HEADERS = {f"src/{name}": "" for name in (
    "rtapi/base/pose.hpp", "rtapi/sync/cell.hpp", "hal/component.hpp", "hal/client/client.hpp", "hal/cmd/shell.hpp",
    "ini/reader.hpp", "interp/canon.hpp", "motion/api/status.hpp", "motion/core/planner/planner.hpp",
    "task/api/client.hpp", "task/command/server.hpp", "io/tool_table.hpp")}


def including(name, include):
    return complaints({**HEADERS, name: f"#pragma once\n#include {include}\n"})


class Layers(unittest.TestCase):
    def test_allowed(self):
        for name, include in [
            ("src/interp/x.cpp", '"rtapi/base/pose.hpp"'),
            ("src/hal/x.cpp", '"rtapi/sync/cell.hpp"'),
            ("src/hal/cmd/x.cpp", '"ini/reader.hpp"'),
            ("src/rtapi/host/x.cpp", '"hal/component.hpp"'),
            ("src/motion/core/x.cpp", '"motion/api/status.hpp"'),
            ("src/motion/core/homing/x.cpp", '"motion/core/planner/planner.hpp"'),
            ("src/task/x.cpp", '"interp/canon.hpp"'),
            ("src/launcher/x.cpp", '"task/api/client.hpp"'),
            ("components/logic/x.cpp", '"hal/component.hpp"'),
            ("src/rtapi/shm/x.cpp", "<boost/interprocess/mapped_region.hpp>"),
            ("src/task/x.cpp", "<nlohmann/json.hpp>"),
            ("src/task/x.cpp", "<thread>"),
        ]:
            self.assertEqual(including(name, include), [], f"{name} includes {include}")

    def test_forbidden(self):
        for name, include in [
            ("src/rtapi/base/x.hpp", '"hal/component.hpp"'),
            ("src/ini/x.cpp", '"rtapi/base/pose.hpp"'),
            ("src/hal/x.cpp", '"ini/reader.hpp"'),
            ("src/hal/x.cpp", '"hal/cmd/shell.hpp"'),
            ("src/hal/x.cpp", '"motion/api/status.hpp"'),
            ("src/motion/api/x.hpp", '"hal/component.hpp"'),
            ("src/motion/core/x.cpp", '"hal/component.hpp"'),
            ("src/motion/core/x.cpp", "<thread>"),
            ("src/motion/core/x.cpp", "<cstdio>"),
            ("src/interp/x.cpp", '"motion/api/status.hpp"'),
            ("src/interp/x.cpp", "<mutex>"),
            ("src/io/x.cpp", '"interp/canon.hpp"'),
            ("src/task/x.cpp", '"motion/core/planner/planner.hpp"'),
            ("src/launcher/x.cpp", '"interp/canon.hpp"'),
            ("src/launcher/x.cpp", '"task/command/server.hpp"'),
            ("components/logic/x.cpp", '"hal/client/client.hpp"'),
            ("components/math/x.cpp", '"components/logic/other.hpp"'),
            ("src/hal/x.cpp", "<boost/interprocess/mapped_region.hpp>"),
            ("src/task/x.hpp", "<nlohmann/json.hpp>"),
            ("src/interp/x.cpp", "<nlohmann/json.hpp>"),
            ("src/nowhere/x.cpp", '"rtapi/base/pose.hpp"'),
            ("src/hal/x.cpp", '"no/such/header.hpp"'),
        ]:
            found = including(name, include)
            self.assertEqual(len(found), 1, f"{name} includes {include}: {found}")
            self.assertIn(f"{name}:2: ", found[0])


if __name__ == "__main__":
    unittest.main()
