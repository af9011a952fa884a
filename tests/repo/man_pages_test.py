"""Each program has a manual page that knows its options; groff finds nothing to complain of."""
import os
import pathlib
import re
import shutil
import subprocess
import unittest

TOP = pathlib.Path(__file__).resolve().parents[2]
MAN = TOP / "docs/man"
BIN = pathlib.Path(os.environ.get("KERF_BUILD_DIR", TOP / "build/dev")).resolve() / "bin"
SECTIONS = ("NAME", "SYNOPSIS", "DESCRIPTION", "OPTIONS", "EXIT STATUS", "EXAMPLES", "SEE ALSO")


def plain(roff):
    return re.sub(r"\\f[BIRP]", "", roff).replace(r"\-", "-")


def section(roff, name):
    match = re.search(rf'^\.SH "?{name}"?\n(.*?)(?=^\.SH |\Z)', roff, re.M | re.S)
    return match.group(1) if match else ""


def options(text, dashes):
    return set(re.findall(rf"(?<![\w-]){dashes}[A-Za-z][\w-]*", text))


def help_of(program):
    """What the program says to --help, or to -h if it has no long options."""
    for ask in ("--help", "-h"):
        run = subprocess.run([program, ask], capture_output=True, text=True, check=False, timeout=60,
                             stdin=subprocess.DEVNULL, env={**os.environ, "KERF_INSTANCE": "man-pages-test"})
        if run.returncode == 0:
            break
    return run.stdout + run.stderr


class ManPages(unittest.TestCase):
    def setUp(self):
        self.pages = sorted((MAN / "man1").glob("*.1"))
        self.assertGreater(len(self.pages), 5)

    @unittest.skipUnless(BIN.is_dir(), "no programs are built")
    def test_programs_and_their_options_have_a_page(self):
        for program in sorted(p for p in BIN.iterdir() if os.access(p, os.X_OK) and p.is_file()):
            with self.subTest(program.name):
                page = MAN / "man1" / f"{program.name}.1"
                self.assertTrue(page.is_file(), f"docs/man/man1/{page.name} is missing")
                text, said = plain(page.read_text()), help_of(program)
                # A summary that names no option would make the next lines empty promises.
                self.assertTrue(options(said, "-{1,2}"), f"{program.name} --help names no option")
                described = section(text, "OPTIONS")
                self.assertEqual(options(said, "--") - options(described, "--"), set(), "not in OPTIONS")
                self.assertEqual(options(described, "--") - options(said, "--") - {"--help"}, set(), "not in --help")
                # halcmd's help explains its commands too, whose options have other sections.
                self.assertEqual(options(said, "-") - options(text, "-"), set(), "nowhere in the page")

    def test_pages_belong_to_programs(self):
        lists = list((TOP / "src").rglob("CMakeLists.txt"))
        known = set(re.findall(r"kerf_(?:program|script)\(([\w-]+)", "".join(f.read_text() for f in lists))) | {"linuxcnc"}
        # Commands of a program may have pages of their own: halcmd-check.
        self.assertEqual({page.stem for page in self.pages if page.stem.split("-")[0] not in known} - known, set())

    @unittest.skipUnless((BIN / "hal").exists(), "hal is not built")
    def test_commands_with_pages_of_their_own(self):
        for command, page in (("check", "halcmd-check"), ("graph", "halcmd-graph"), ("describe", "hal")):
            with self.subTest(command):
                run = subprocess.run([BIN / "hal", command, "--help"], capture_output=True, text=True, check=True, timeout=60)
                described = section(plain((MAN / f"man1/{page}.1").read_text()), "OPTIONS")
                for dashes in ("--", "-"):
                    self.assertEqual(options(run.stdout, dashes) - options(described, dashes), set())

    def test_pages_have_their_sections(self):
        for page in self.pages:
            text = page.read_text()
            with self.subTest(page.name):
                self.assertEqual([s for s in SECTIONS if not section(text, s).strip()], [])
                self.assertRegex(section(text, "NAME"), rf"\b{page.stem}\b.*\\- ")
                self.assertTrue(section(text, "ENVIRONMENT") or section(text, "FILES"))

    def test_see_also_leads_to_pages(self):
        names = {page.stem for page in self.pages}
        for page in self.pages:
            for name in re.findall(r"^\.BR ([\w-]+) \(1\)", page.read_text(), re.M):
                self.assertIn(name, names, page.name)

    @unittest.skipUnless(shutil.which("groff"), "groff is not installed")
    def test_groff_has_no_warnings(self):
        for page in self.pages:
            run = subprocess.run(["groff", "-man", "-Tutf8", "-ww", "-z", f"man1/{page.name}"], cwd=MAN,
                                 capture_output=True, text=True, check=False)
            self.assertEqual((run.returncode, run.stderr), (0, ""), page.name)

    @unittest.skipUnless(shutil.which("groff"), "groff is not installed")
    @unittest.skipUnless((BIN.parent / "man/man9").is_dir(), "no pages of components are built")
    def test_groff_has_no_warnings_about_components(self):
        pages = sorted((BIN.parent / "man/man9").glob("*.9"))
        self.assertGreater(len(pages), 10)
        run = subprocess.run(["groff", "-man", "-Tutf8", "-ww", "-z", *pages], capture_output=True, text=True, check=False)
        self.assertEqual((run.returncode, run.stderr), (0, ""))


if __name__ == "__main__":
    unittest.main(verbosity=2)
