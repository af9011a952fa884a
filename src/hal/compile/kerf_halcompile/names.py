"""From the names in a .comp file to those of C and of HAL."""
import re

# Names that the generated file or the macros have for themselves.
RESERVED = {"comp_id", "fperiod", "rtapi_app_main", "rtapi_app_exit", "extra_setup", "extra_cleanup", "post_export"}
C_WORDS = set("""auto break case char const continue default do double else enum extern float for goto if inline int long register
    restrict return short signed sizeof static struct switch typedef union unsigned void volatile while""".split())
CXX_WORDS = set("""alignas alignof and and_eq asm bitand bitor bool catch class compl concept const_cast consteval constexpr constinit
    decltype delete dynamic_cast explicit export false friend mutable namespace new noexcept not not_eq nullptr operator or or_eq
    private protected public reinterpret_cast requires static_assert static_cast template this thread_local throw true try
    typeid typename using virtual wchar_t xor xor_eq""".split())


def to_c(name):
    """x-y.z -> x_y_z, x.## -> x. A '_' at the end stays: it is there to keep away from a word of C."""
    name = re.sub(r"[-._]*#+", "", name)
    name = re.sub(r"[-.#]", "_", name)
    return re.sub(r"_+", "_", name)


def to_hal(name):
    """x_y_ -> x-y"""
    return re.sub(r"[-.]+$", "", name.replace("_", "-"))


def component_to_hal(name):
    return to_hal(name[4:] if name.startswith("hal_") else name)


def hal_format(name):
    """The name as a format of printf, with one %d for an array: in-## -> in-%02d."""
    return re.sub(r"#+", lambda m: f"%0{len(m.group())}d" if len(m.group()) > 1 else "%d", to_hal(name))


def hash_runs(name):
    return len(re.findall(r"#+", name))
