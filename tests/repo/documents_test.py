"""Documents agree with the tree: links lead somewhere, faults have pages, configured keys are documented."""
import pathlib
import re
import subprocess
import unittest

TOP = pathlib.Path(__file__).resolve().parents[2]


def tracked(*patterns):
    out = subprocess.run(["git", "ls-files", "--", *patterns], cwd=TOP, capture_output=True, text=True, check=False)
    return [TOP / line for line in out.stdout.splitlines() if (TOP / line).is_file()]


class Documents(unittest.TestCase):
    def test_links_lead_to_files(self):
        for page in tracked("*.md"):
            for target in re.findall(r"\]\(([^)#\s]+)(?:#[^)]*)?\)", page.read_text()):
                if "://" not in target:
                    self.assertTrue((page.parent / target).exists(), f"{page.relative_to(TOP)} links to {target}")

    def test_every_fault_has_a_page(self):
        header = (TOP / "src/motion/api/status.hpp").read_text()
        body = re.search(r"enum class Fault [^{]*\{(.*?)\};", header, re.S).group(1)
        names = re.findall(r"^\s*([a-z_]+) = \d+", body, re.M)
        self.assertGreater(len(names), 20)
        pages = TOP / "docs/troubleshooting"
        if not pages.is_dir():
            self.skipTest("docs/troubleshooting is not there")
        missing = [name for name in names
                   if name != "none" and not any((pages / f"{n}.md").is_file() for n in (name, name.replace("_", "-")))]
        self.assertEqual(missing, [], "faults without a page in docs/troubleshooting")

    def test_names_for_python_are_documented(self):
        page = (TOP / "docs/python-remaps.md").read_text()
        for file, pattern in (("script_self.cpp", r'\{"(\w+)", k(?:Real|Int|Bool),'), ("script_canon.cpp", r'\{"([A-Z_]+)", \d')):
            names = re.findall(pattern, (TOP / "src/interp" / file).read_text())
            self.assertGreater(len(names), 40)
            self.assertEqual([name for name in names if f"`{name}`" not in page], [], file)

    def test_keys_of_the_sample_are_documented(self):
        """Every key of the sample INI stands in docs/configuration.md, or one of its HAL files uses it."""
        documented = (TOP / "docs/configuration.md").read_text()
        folder = TOP / "configs/sim/mill"
        hal = "".join(f.read_text() for f in folder.glob("*.hal"))
        section = ""
        for number, line in enumerate((folder / "mill.ini").read_text().splitlines(), 1):
            if match := re.match(r"\[(\w+)\]", line):
                section = match.group(1)
            elif match := re.match(r"(\w+)\s*=", line):
                key = match.group(1)
                known = re.search(rf"\b{key}\b", documented) or f"[{section}]{key}" in hal
                self.assertTrue(known, f"mill.ini:{number}: [{section}]{key}")

    def test_hal_files_refer_to_keys_that_exist(self):
        folder = TOP / "configs/sim/mill"
        keys, section = set(), ""
        for line in (folder / "mill.ini").read_text().splitlines():
            if match := re.match(r"\[(\w+)\]", line):
                section = match.group(1)
            elif match := re.match(r"(\w+)\s*=", line):
                keys.add(f"[{section}]{match.group(1)}")
        for file in folder.glob("*.hal"):
            for number, line in enumerate(file.read_text().splitlines(), 1):
                for used in re.findall(r"\[\w+\]\w+", line.split("#")[0]):
                    self.assertIn(used, keys, f"{file.name}:{number}")

    def test_scripts_have_help(self):
        for script in tracked("scripts/*"):
            if script.suffix in (".txt", ".md") or script.parent.name == "lib":
                continue
            run = subprocess.run([script, "--help"], capture_output=True, text=True, check=False, cwd="/tmp")
            self.assertEqual(run.returncode, 0, f"{script.name} --help: {run.stderr}")
            self.assertIn(script.name, run.stdout, f"{script.name} --help")

    def test_readme_has_a_short_session(self):
        match = re.search(r"<!-- session -->\s*```sh\n(.*?)```", (TOP / "README.md").read_text(), re.S)
        self.assertIsNotNone(match)
        self.assertLessEqual(len(match.group(1).splitlines()), 10)

    def test_pages_named_in_texts_exist(self):
        pattern = re.compile(r"(?<![\w/.-])(?:docs/[a-z0-9_/-]+|[A-Z]{4,})\.md\b")
        missing = [f"{file.relative_to(TOP)} names {page}" for file in tracked("*.md", "*.hpp", "*.cpp", "scripts", "cmake")
                   for page in pattern.findall(file.read_text(errors="replace")) if not (TOP / page).is_file()]
        self.assertEqual(missing, [])

    def test_no_machine_paths(self):
        """Nothing in the tree names folders of a developer's machine."""
        for file in tracked("*.md", "scripts", "configs", "nc_files", "src", "components", "docs"):
            text = file.read_text(errors="replace")
            self.assertIsNone(re.search(r"(?<![\w.])/(work|home/\w)\w*/", text), file.relative_to(TOP))


if __name__ == "__main__":
    unittest.main()
