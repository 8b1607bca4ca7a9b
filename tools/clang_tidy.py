#!/usr/bin/env python3
"""Runs clang-tidy over all sources but tests.

    tools/clang_tidy.py BUILD

BUILD is the folder of a finished build, with its compile_commands.json.

Nearly all of clang-tidy's time goes into headers, so sources of the same flags are checked several at a
time, joined to one text (a unit). What a source declares for itself alone (`local_names`) is numbered
there, and where that cannot be, only sources join that do not say the word: every name means what it
means without the others. A unit with a finding is done over source by source, so what is reported is
always of one source as it stands.

What was found clean is remembered in .cache/clang-tidy until the source, a header, .clang-tidy or
clang-tidy itself changes.
"""

import concurrent.futures
import hashlib
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
CACHE = ROOT / ".cache/clang-tidy"
FOLDERS = ("src", "techniques", "apps")
# Larger units save nothing more, and leave cores without work at the end.
MOST_IN_UNIT = 16
# A joined text includes headers again; tools/check_includes.py has the same rule.
NOT_IN_UNITS = "-readability-duplicate-include"

# What would change the meaning of sources that come after.
LEAKS = re.compile(r"^\s*#\s*(define|undef|pragma)\b|^using namespace\b", re.MULTILINE)
COMMENT_OR_STRING = re.compile(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"', re.DOTALL)
INCLUDE = re.compile(r"\s*#\s*include\b")
QUOTED_INCLUDE = re.compile(r'^(\s*#\s*include\s*)"([^"]+)"', re.MULTILINE)
# clang-format puts what stands in a namespace, and nothing else, at the start of a line.
NOT_A_NAME = re.compile(r"[\s#}/]|(inline )?namespace\b|static_assert\b|template\b|extern\b|public:|private:|protected:")
NAMED_TYPE = re.compile(r"(?:struct|class|enum(?: class)?|union|using) (?:[\w:]*::)?(\w+)")
WORD = re.compile(r"[A-Za-z_]\w*")
MEMBER = re.compile(r"(?:\.|->|::)\s*([A-Za-z_]\w*)")
DECLARED = re.compile(r"(\w+)\s*(?:[({=\[;]|$)")


def local_names(text):
    """What a source declares in unnamed namespaces, as statics or by `using`."""
    names, unnamed = set(), False
    for line in re.sub(r"\balignas\([^)]*\) ", "", text).splitlines():
        if line.startswith("namespace {"):
            unnamed = True
        elif line == "}  // namespace":
            unnamed = False
        local = unnamed or line.startswith(("static ", "using "))
        if not local or not line or NOT_A_NAME.match(line):
            continue
        if match := NAMED_TYPE.match(line) or DECLARED.search(line):
            names.add(match.group(1))
    return names


class Source:
    """One source with its entry of compile_commands.json."""

    def __init__(self, entry):
        self.entry = entry
        self.path = pathlib.Path(entry["file"])
        self.text = self.path.read_text(encoding="utf-8")
        code = COMMENT_OR_STRING.sub(" ", QUOTED_INCLUDE.sub("", self.text))
        self.words = set(WORD.findall(code))
        names = local_names(self.text)
        # What is also a member, or another namespace's, keeps its name.
        self.fixed = names & {match.group(1) for match in MEMBER.finditer(code)}
        self.numbered = names - self.fixed
        self.leaks = LEAKS.search(code) is not None
        self.folders, self.defines, self.flags = [], {}, []
        arguments = iter(shlex.split(entry["command"])[1:])
        for argument in arguments:
            if argument in ("-o", "-c"):
                next(arguments)
            elif argument == "-isystem":
                self.folders.append(f"-isystem{next(arguments)}")
            elif argument.startswith("-I"):
                self.folders.append(argument)
            elif argument.startswith("-D"):
                self.defines[re.split(r"[=(]", argument[2:])[0]] = argument
            else:
                self.flags.append(argument)

    def leaves(self, other):
        """Whether `other` means the same after this one's text and with its macros."""
        new = self.defines.items() - other.defines.items()
        return (not self.leaks and self.fixed.isdisjoint(other.words)
                and not any(name in other.defines or name in other.words for name, _ in new))

    def joins(self, other):
        return self.flags == other.flags and self.leaves(other) and other.leaves(self)

    def text_for_unit(self, number):
        """Its text, in which quoted includes are whole paths, found as the compiler would."""
        places = [self.path.parent] + [pathlib.Path(f[2:]) for f in self.folders if f.startswith("-I")]

        def whole(match):
            found = next((p / match.group(2) for p in places if (p / match.group(2)).exists()), match.group(2))
            return f'{match.group(1)}"{found}"'

        def numbered(match):
            return f"{match.group()}{number}" if match.group() in self.numbered else match.group()

        lines = [QUOTED_INCLUDE.sub(whole, line) if INCLUDE.match(line) else WORD.sub(numbered, line)
                 for line in self.text.splitlines()]
        return "\n".join(lines) + "\n"


def units_of(sources):
    """`sources` in as few lists as their names allow, greedily, neighbours first."""
    units = []
    for source in sources:
        for unit in units:
            if len(unit) < MOST_IN_UNIT and all(source.joins(other) for other in unit):
                unit.append(source)
                break
        else:
            units.append([source])
    return sorted(units, key=len, reverse=True)


def clang_tidy(build, file, *options):
    """None where nothing is found, else what is."""
    done = subprocess.run(["clang-tidy", "--quiet", "--extra-arg=-Wno-unknown-warning-option", *options,
                           "-p", str(build), str(file)], capture_output=True, text=True, check=False)
    return None if done.returncode == 0 else done.stdout + done.stderr


def check_joined(unit):
    """As clang_tidy(), of several sources at once."""
    with tempfile.TemporaryDirectory() as folder:
        joined = pathlib.Path(folder) / "unit.cpp"
        texts = [source.text_for_unit(number) for number, source in enumerate(unit, 1)]
        joined.write_text("\n".join(texts), encoding="utf-8")
        folders = dict.fromkeys(folder for source in unit for folder in source.folders)
        defines = {name: define for source in unit for name, define in source.defines.items()}
        command = ["c++", *folders, *defines.values(), *unit[0].flags, "-c", str(joined)]
        entry = {"directory": unit[0].entry["directory"], "file": str(joined), "arguments": command}
        (joined.parent / "compile_commands.json").write_text(json.dumps([entry]), encoding="utf-8")
        return clang_tidy(joined.parent, joined, f"--checks={NOT_IN_UNITS}",
                          f"--config-file={ROOT}/.clang-tidy")


def check(build, unit, key_of):
    """The findings of a unit's sources; notes what is clean."""
    findings = []
    clean_together = len(unit) > 1 and check_joined(unit) is None
    for source in unit:
        found = None if clean_together else clang_tidy(build, source.path)
        if found is None:
            (CACHE / key_of(source)).touch()
        else:
            findings.append(found)
    return findings


def main():
    build = pathlib.Path(sys.argv[1])
    headers = sorted(file for folder in ("include", *FOLDERS) for file in (ROOT / folder).rglob("*.h"))
    common = b"".join(file.read_bytes() for file in [*headers, ROOT / ".clang-tidy", pathlib.Path(__file__)])
    common += subprocess.run(["clang-tidy", "--version"], capture_output=True, check=True).stdout

    def key_of(source):
        return hashlib.sha256(common + f"{source.path} {source.text}".encode()).hexdigest()[:40]

    CACHE.mkdir(parents=True, exist_ok=True)
    entries = json.loads((build / "compile_commands.json").read_text(encoding="utf-8"))
    wanted = tuple(f"{ROOT / folder}/" for folder in FOLDERS)
    by_path = {entry["file"]: entry for entry in entries
               if entry["file"].startswith(wanted) and not entry["file"].endswith("_test.cpp")}
    sources = [Source(by_path[path]) for path in sorted(by_path)]
    units = units_of([source for source in sources if not (CACHE / key_of(source)).exists()])
    print(f"{sum(map(len, units))} of {len(sources)} sources have changed: {len(units)} runs", flush=True)

    failed = False
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for findings in pool.map(lambda unit: check(build, unit, key_of), units):
            for found in findings:
                failed = True
                print(found, flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
