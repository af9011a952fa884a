"""The compiler's calls: realtime components (.so) and programs."""
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys

C_SUFFIXES = (".c", ".cc", ".cpp", ".cxx")
BLOCKING = set("""malloc calloc realloc free printf fprintf puts sleep usleep nanosleep fopen open read write
    pthread_mutex_lock""".split())


class BuildError(Exception):
    pass


class Tools:
    """Where things are, seen from the program in bin/."""

    def __init__(self, bin_folder):
        self.bin = pathlib.Path(bin_folder)
        top = self.bin.parent
        self.include, self.lib, self.share = top / "include", top / "lib", top / "share"
        own = os.environ.get("KERF_COMPONENTS", "").split(":")[0]
        self.components = pathlib.Path(own) if own else top / "components"
        self.man = pathlib.Path(os.environ.get("KERF_MAN") or top / "man")

    def flags(self, userspace):
        common = ["-D_GNU_SOURCE", "-O2", "-g"]
        if userspace:
            return ["-DULAPI", *common, "-fno-strict-aliasing", f"-I{self.include}"]
        return ["-DRTAPI", *common, "-fPIC", "-fno-strict-aliasing", f"-I{self.include}"]

    def modinc(self):
        path = self.share / "Makefile.modinc"
        if not path.is_file():
            raise BuildError(f"{path} is missing: this build is not complete")
        return path.resolve()


def run(command):
    if subprocess.run(command, check=False).returncode != 0:
        raise BuildError("")  # the compiler has said why


def output_of(command):
    return subprocess.run(command, capture_output=True, check=False).stdout


def compile_one(tools, source, target, userspace, more, shown=None):
    """`shown`: the name in the message, when `source` is a file in between."""
    if not (tools.include / "hal.h").is_file():
        raise BuildError(f"{tools.include}/hal.h is missing: this build is not complete")
    if str(source).endswith(".c"):
        command = shlex.split(os.environ.get("CC", "gcc")) + ["-std=gnu17", "-Wno-declaration-after-statement"]
    else:
        command = shlex.split(os.environ.get("CXX", "g++")) + ["-std=gnu++20" if shown else "-std=gnu++17"]
    print(f"Compiling {'program' if userspace else 'realtime'} {shown or source}", flush=True)
    run(command + tools.flags(userspace) + ["-Wall"] + more + ["-c", str(source), "-o", str(target)])


def link_program(tools, out, objects, more):
    print(f"Linking {pathlib.Path(out).name}", flush=True)
    lib = tools.lib.resolve()
    # Without it the linker would take another one that the system has.
    if not (lib / "liblinuxcnchal.so").exists():
        raise BuildError(f"{lib}/liblinuxcnchal.so is missing: this build is not complete")
    run(shlex.split(os.environ.get("CXX", "g++")) + ["-o", str(out), *map(str, objects), f"-L{lib}", f"-Wl,-rpath,{lib}", *more,
                                                    "-llinuxcnchal", "-lm", "-lpthread"])


# What a module may leave to Kerf: share/kins.
KINEMATICS_HELPERS = set("""map_coordinates_to_jnumbers mapped_joints_to_position position_to_mapped_joints
    identityKinematicsSetup identityKinematicsForward identityKinematicsInverse
    userkKinematicsSetup userkKinematicsForward userkKinematicsInverse""".split())


def symbols_of(objects):
    """The names that the objects define, and those that they want from elsewhere."""
    defined, wanted = set(), set()
    for item in objects:
        for line in output_of(["nm", "-g", str(item)]).decode().splitlines():
            words = line.split()
            (wanted if words[-2] in "Uw" else defined).add(words[-1])
    return defined, wanted - defined


def add_kinematics(tools, objects, work):
    """The common part of a module that has only switchkinsSetup, and the helpers of kinematics.h."""
    def compiled(name):
        item = work / f"kins-{name}.o"
        compile_one(tools, tools.share / "kins" / f"{name}.c", item, False, [], f"{name}.c")
        return item
    defined, wanted = symbols_of(objects)
    if "switchkinsSetup" in defined and "rtapi_app_main" not in defined:
        objects = [*objects, compiled("switchkins")]
    if wanted & KINEMATICS_HELPERS:
        objects = [*objects, compiled("kins_util")]
    return objects


def link_realtime(tools, out, objects, more, work, me):
    objects = add_kinematics(tools, objects, work)
    exports, has_main = ["rtapi_module_table", "rtapi_app_main", "rtapi_app_exit"], False
    for index, item in enumerate(objects):
        has_main = has_main or b" T rtapi_app_main\n" in output_of(["nm", "--defined-only", str(item)])
        # What EXPORT_SYMBOL names, each ended by a zero byte.
        raw = work / f"exports{index}"
        subprocess.run(["objcopy", "-O", "binary", "--only-section=.rtapi_export", "--set-section-flags", ".rtapi_export=alloc",
                        str(item), str(raw)], capture_output=True, check=False)
        if raw.is_file():
            exports += [name.decode() for name in raw.read_bytes().split(b"\0") if name]
        # Right in rtapi_app_main and wrong in a HAL function; which of the two it is, nobody sees here.
        for line in output_of(["nm", "-u", str(item)]).decode().split("\n"):
            name = line.split()[-1] if line.split() else ""
            if name in BLOCKING:
                print(f"{me}: note: {pathlib.Path(item).name} calls {name}(): not to be done in a HAL function", file=sys.stderr)
    if not has_main:
        raise BuildError(f"no rtapi_app_main in {pathlib.Path(out).name}: is it a program? then compile with --userspace")
    version_script = work / "exports.map"
    version_script.write_text("{ global: " + " ".join(f"{name};" for name in exports) + " local: *; };\n")
    print(f"Linking {pathlib.Path(out).name}", flush=True)
    # The math library is the module's own business; the rest (rtapi_*, hal_*) is there when it is loaded.
    run(shlex.split(os.environ.get("CXX", "g++")) +
        ["-shared", "-Wl,-Bsymbolic", "-Wl,-z,start-stop-visibility=hidden", f"-Wl,--version-script={version_script}", "-o", str(out),
         *map(str, objects), *more, "-lm"])


def install_python(tools, source):
    """A program in Python under its name without the ending."""
    target = tools.bin / pathlib.Path(source).stem
    text = pathlib.Path(source).read_bytes()
    if not text.startswith(b"#!"):
        raise BuildError(f"{source}:1: a program in Python begins with #!/usr/bin/python3")
    shutil.copyfile(source, target)
    target.chmod(0o755)
    return target


def words_of(text):
    return re.split(r"\s+", text.strip()) if text.strip() else []
