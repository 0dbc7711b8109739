#!/usr/bin/env python3
"""What may be typed next, in bash and zsh, and the manual: all of it made from the table of options."""

import os
import pathlib
import pty
import random
import re
import select
import shutil
import subprocess
import time

import candela
from candela import CliTest, PROGRAM, ROOT

KINDS = {"words", "open words", "files", "open files", "folders"}
# Not a word by itself: more has to follow.
OPEN_ENDED = (":", "=", "/")


class Words(CliTest):
    def words(self, *typed):
        """How the shell is to go on, and the words that the last one may become."""
        lines = self.succeeds("completion", "words", *typed).out.splitlines()
        self.assertIn(lines[0], KINDS)
        for line in lines[1:]:
            self.assertRegex(line, r"\A[^\t]+\t[^\t]*\Z")
            self.assertTrue(line.startswith(typed[-1] if typed else ""), line)
        words = [line.split("\t")[0] for line in lines[1:]]
        self.assertEqual(len(words), len(set(words)), words)
        return lines[0], words

    def verbs(self):
        return [verb for verb in self.words("")[1] if verb != "help"]

    def options(self, verb):
        return self.words(verb, "--")[1]

    def values(self, verb, option):
        """Of an option that is written --option=VALUE."""
        return [word.partition("=")[2] for word in self.words(verb, f"{option}=")[1]]

    def test_verbs_are_those_of_the_help_with_what_they_do(self):
        text = self.succeeds("--help").out
        named = re.findall(r"^  ([a-z]+) +(\S.*)$", text[text.index("Verbs:") :], re.MULTILINE)
        lines = self.succeeds("completion", "words", "").out.splitlines()[1:]
        self.assertEqual(sorted(f"{verb}\t{what}" for verb, what in named), sorted(l for l in lines if not l.startswith("help\t")))
        self.assertGreater(len(named), 10)
        self.assertEqual(self.words("wor"), ("words", ["worker"]))
        self.assertEqual(self.words("--v"), ("words", ["--version"]))
        self.assertIn("demos", self.words("help", "")[1])
        self.assertIn("render", self.words("help", "")[1])

    def test_every_option_of_the_long_help_is_there(self):
        for verb in self.verbs():
            text = self.succeeds(verb, "--help", "all").out
            named = set(re.findall(r"^ +(?:-\w,)?(--[a-z-]+)", text, re.MULTILINE))
            self.assertEqual(set(self.options(verb)), named, verb)

    def test_what_is_completed_is_accepted(self):
        checked = 0
        for verb in self.verbs():
            for option in self.options(verb):
                for word in self.values(verb, option):
                    if word.endswith(OPEN_ENDED) or option == "--from-scene":
                        continue
                    result = self.run_candela(verb, f"{option}={word}", "--absent")
                    self.assertEqual(result.code, 2, f"{verb} {option} {word}")
                    self.assertRegex(result.err, "has no option --absent|is required")
                    checked += 1
        self.assertGreater(checked, 200)

    def test_words_are_all_that_a_refusal_names(self):
        compared = []
        for verb in self.verbs():
            for option in self.options(verb):
                words = self.values(verb, option)
                if not words:
                    continue
                result = self.run_candela(verb, f"{option}=@@@", "--absent")
                listed = re.search(r"^candela: " + option + r": .*(?:is none of |\(known: )([^)\n]*)", result.err)
                if not listed or "'@@@'" in listed[1]:
                    continue
                self.assertLessEqual(set(listed[1].split(", ")), set(words), f"{verb} {option}")
                compared.append(option)
        self.assertGreaterEqual(len(compared), 20, compared)
        self.assertLessEqual({"--tonemap", "--format", "--aov", "--views", "--method", "--engine", "--view"}, set(compared))

    def test_types_with_alternatives_give_those_that_are_words(self):
        self.assertEqual(self.words("render", "--background", ""), ("words", ["env", "transparent"]))
        self.assertEqual(self.words("render", "--unit", ""), ("words", ["mm", "cm", "m", "in"]))
        self.assertEqual(self.words("render", "--ground", ""), ("words", ["shadow", "mirror:"]))
        self.assertEqual(self.words("render", "--cameras", ""), ("files", ["sphere:"]))
        self.assertEqual(self.words("render", "--env", "studio:"), ("files", ["studio:dark", "studio:three-point"]))
        self.assertEqual(self.words("render", "--denoise="), ("words", ["--denoise=regression", "--denoise=oidn", "--denoise=none"]))
        self.assertEqual(self.words("render", "--spp", ""), ("words", []))

    def test_lists_go_on_after_a_comma_without_what_is_there(self):
        kind, words = self.words("render", "--aov", "albedo,n")
        self.assertEqual((kind, words), ("open words", ["albedo,normal"]))
        _, words = self.words("render", "--aov", "albedo,depth,")
        self.assertIn("albedo,depth,normal", words)
        self.assertNotIn("albedo,depth,albedo", words)
        self.assertEqual(self.words("render", "--aov=albedo,n"), ("open words", ["--aov=albedo,normal"]))
        self.assertEqual(self.words("check", "--ignore", ",,"), self.words("check", "--ignore", ",,"))

    def test_an_option_is_offered_once_unless_it_may_be_repeated(self):
        used = self.options("render")
        self.assertIn("--size", used)
        _, left = self.words("render", "a.glb", "--size", "16x16", "-o", "a.png", "--")
        self.assertNotIn("--size", left)
        self.assertIn("--output", left)
        self.assertEqual(set(used) - set(left), {"--size"})

    def test_a_word_behind_an_option_that_takes_one_is_its_value(self):
        self.assertEqual(self.words("render", "--eye", "-"), ("words", []))
        self.assertEqual(self.words("render", "-o", "--si")[0], "files")
        self.assertEqual(self.words("bake", "--diff", "a", ""), ("files", []))
        self.assertEqual(self.words("bake", "--diff", "a", "b", "--tabl")[1], ["--tables", "--table-size"])
        self.assertEqual(self.words("bake", "-o", "")[0], "folders")

    def test_inputs_are_files_and_built_in_scenes_as_many_as_the_verb_takes(self):
        self.assertEqual(self.words("render", "demo:row-io"), ("files", ["demo:row-ior"]))
        self.assertEqual(self.words("render", "a.glb", "demo:row-io"), ("files", ["demo:row-ior"]))
        self.assertEqual(self.words("info", "a.glb", "demo:row-io"), ("words", []))
        self.assertEqual(self.words("diff", "a.glb", "demo:row-io"), ("files", ["demo:row-ior"]))
        self.assertEqual(self.words("diff", "a.glb", "b.glb", "demo:row-io"), ("words", []))
        self.assertEqual(self.words("completion", ""), ("words", ["bash", "zsh", "man"]))
        for verb in self.verbs():
            kind, words = self.words(verb, "")
            self.assertTrue(kind == "files" or words, verb)

    def test_behind_the_dashes_of_plan_is_a_command_of_render(self):
        self.assertEqual(self.words("plan", "-o", "city/", "--", "city.glb", "--turn"), ("words", ["--turntable"]))
        self.assertEqual(self.words("plan", "-o", "city/", "--turn"), ("words", []))

    def test_no_words_are_too_strange(self):
        random.seed(1)
        some = ["", "-", "--", "=", ":", "--=", "render", "plan", "help", "-o", "--denoise=", "--aov", ",", "\t", "a\nb", "--help", "all", "ä", "-oa", "@"]
        self.words()
        for _ in range(60):
            typed = random.choices(some, k=random.randint(1, 5))
            result = self.succeeds("completion", "words", *typed)
            self.assertIn(result.out.split("\n")[0], KINDS)
            self.assertEqual(result.err, "")

    def test_only_what_there_is_is_printed(self):
        self.refuses("completion", says="KIND")
        self.refuses("completion", "fish", says="'fish' is none of bash, zsh, man")
        self.refuses("completion", "bash", "-o", "folder", says="--output: only of man")
        self.refuses("completion", "man", says="-o DIR")


class Shell(CliTest):
    """A shell in a folder with a few files, for which the program is `candela`."""

    def setUp(self):
        super().setUp()
        (self.folder / "bin").mkdir()
        (self.folder / "bin/candela").symlink_to(pathlib.Path(PROGRAM).resolve())
        self.work = self.folder / "work"
        self.work.mkdir()
        (self.work / "two words.glb").touch()
        (self.work / "models").mkdir()
        (self.work / "paint.hdr").touch()
        path = f"{self.folder / 'bin'}:{os.environ['PATH']}"
        self.environment = {**os.environ, "PATH": path, "TERM": "xterm", "HOME": str(self.folder), "LC_ALL": "C.UTF-8"}

    def shell(self, name):
        found = shutil.which(name)
        if not found:
            self.skipTest(f"{name} is not installed")
        return found

    def type_into(self, shell, setup, typed):
        """Types at a real prompt, a tab included, and returns the line that this has become."""
        try:
            master, slave = pty.openpty()
        except OSError as error:
            self.skipTest(f"no terminals here: {error}")
        process = subprocess.Popen(shell, cwd=self.work, env=self.environment, stdin=slave, stdout=slave, stderr=slave, start_new_session=True)
        self.addCleanup(self.end, process)
        os.close(slave)
        # The line is echoed in brackets once it is complete, so that nothing but the shell's own echo is read.
        os.write(master, f"stty cols 500; {setup}\n".encode())
        self.read_until(master, rb"READY-1", process)
        os.write(master, f"{typed}\t\x01printf '<%s>' \x05; echo '!DONE'-$((1+1))\n".encode())
        seen = self.read_until(master, rb"!DONE-2", process)
        os.close(master)
        return re.findall(r"<([^<>]*)>", seen[: seen.index("!DONE-2")][seen.rindex("\n", 0, seen.index("!DONE-2")) :])

    def read_until(self, master, pattern, process):
        seen, end = b"", time.monotonic() + 60
        while not re.search(pattern, seen):
            ready, _, _ = select.select([master], [], [], max(0, end - time.monotonic()))
            self.assertTrue(ready, f"no answer: {seen!r}")
            seen += os.read(master, 4096)
        return seen.decode(errors="replace")

    def test_bash_completes_at_a_prompt(self):
        setup = "bind 'set enable-bracketed-paste off'; PS1='> '; source <(candela completion bash); echo READY-$((0+1))"
        for typed, becomes in PROMPTS.items():
            line = self.type_into([self.shell("bash"), "--norc", "--noprofile", "-i"], setup, typed)
            self.assertEqual(line, becomes, typed)

    def test_zsh_completes_at_a_prompt(self):
        for how in ("source <(candela completion zsh)", None):
            functions = self.folder / "functions"
            functions.mkdir(exist_ok=True)
            if how is None:  # as a package installs it
                (functions / "_candela").write_text(self.succeeds("completion", "zsh").out)
            setup = (f"PS1='> '; unsetopt beep zle_bracketed_paste; fpath=({functions} $fpath); autoload -U compinit; compinit -u -D; "
                     f"{how or 'true'}; echo READY-$((0+1))")  # fmt: skip
            for typed, becomes in PROMPTS.items():
                line = self.type_into([self.shell("zsh"), "-f", "-i"], setup, typed)
                self.assertEqual(line, becomes, f"{typed}, {how}")

    def replies(self, line):
        """What bash's function answers, of a line with the cursor at its end."""
        pieces = re.findall(r"[=:]+|[^\s=:]+", line) + ([""] if line.endswith(" ") else [])
        script = """
source <(candela completion bash)
COMP_LINE=$1; COMP_POINT=${#1}; shift
COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1))
_candela candela
printf '%s\\n' "${COMPREPLY[@]}"
"""
        done = subprocess.run([self.shell("bash"), "-c", script, "bash", line, *pieces], cwd=self.work, env=self.environment,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=60, check=True)  # fmt: skip
        self.assertEqual(done.stderr, b"")
        return done.stdout.decode().splitlines()

    def test_bash_is_given_only_what_follows_its_own_breaks(self):
        self.assertEqual(self.replies("candela render demo:row-io"), ["row-ior"])
        self.assertEqual(self.replies("candela render --env studio:"), ["dark", "three-point"])
        self.assertEqual(self.replies("candela render --env=studio:d"), ["dark"])
        self.assertEqual(self.replies("candela render --denoise=o"), ["oidn"])
        self.assertEqual(self.replies("candela render --denoise="), ["regression", "oidn", "none"])
        self.assertEqual(self.replies("candela render --aov albedo,n"), ["albedo,normal"])
        self.assertEqual(self.replies("candela  render   --engin"), ["--engine"])
        self.assertEqual(sorted(self.replies("candela render a.glb -o ")), ["models", "paint.hdr", "two words.glb"])
        self.assertEqual(self.replies("candela bake a.hdr -o "), ["models"])
        self.assertEqual(self.replies("candela render two"), ["two words.glb"])
        self.assertEqual(self.replies("candela frobnicate "), [""])

    def test_bash_ignores_what_is_behind_the_cursor(self):
        script = """
source <(candela completion bash)
COMP_LINE='candela render --engine=rasXX a.glb'; COMP_POINT=27; COMP_WORDS=(candela render --engine = rasXX a.glb); COMP_CWORD=4
_candela candela
printf '%s\\n' "${COMPREPLY[@]}"
"""
        done = subprocess.run([self.shell("bash"), "-c", script], cwd=self.work, env=self.environment, stdout=subprocess.PIPE, check=True)
        self.assertEqual(done.stdout, b"raster\n")

    def test_a_program_that_cannot_run_completes_nothing(self):
        script = """
source <(candela completion bash)
COMP_LINE='./absent render '; COMP_POINT=${#COMP_LINE}; COMP_WORDS=(./absent render ''); COMP_CWORD=2
_candela ./absent
printf '%s' "${#COMPREPLY[@]}"
"""
        done = subprocess.run([self.shell("bash"), "-c", script], cwd=self.work, env=self.environment,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=True)  # fmt: skip
        self.assertEqual((done.stdout, done.stderr), (b"0", b""))

    def test_the_scripts_are_the_files_that_are_installed(self):
        for shell in ("bash", "zsh"):
            text = (ROOT / "share/completion" / f"candela.{shell}").read_text()
            self.assertEqual(self.succeeds("completion", shell).out, text)


# What is typed before a tab, and the words that the shell would pass then.
PROMPTS = {
    "candela prev": ["candela", "preview"],
    "candela render demo:row-io": ["candela", "render", "demo:row-ior"],
    "candela render --denoise=oi": ["candela", "render", "--denoise=oidn"],
    "candela render --aov albedo,norm": ["candela", "render", "--aov", "albedo,normal"],
    "candela render two": ["candela", "render", "two words.glb"],
    "candela bake pa": ["candela", "bake", "paint.hdr"],
    "candela render a.glb --studio whi": ["candela", "render", "a.glb", "--studio", "white"],
}


class Manual(CliTest):
    def pages(self):
        self.succeeds("completion", "man", "-o", "man1")
        return {path.name: path for path in sorted((self.folder / "man1").iterdir())}

    def verbs(self):
        text = self.succeeds("--help").out
        return re.findall(r"^  ([a-z]+) +\S", text[text.index("Verbs:") :], re.MULTILINE)

    def read(self, page):
        """As a terminal shows it, on wide lines."""
        if not shutil.which("man"):
            self.skipTest("man is not installed")
        environment = {**os.environ, "MANWIDTH": "2000", "LC_ALL": "C.UTF-8", "GROFF_NO_SGR": "1"}
        done = subprocess.run(["man", "--warnings", "-l", str(page)], env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False)
        self.assertEqual((done.returncode, done.stderr.decode()), (0, ""), page)
        return re.sub(".\b", "", done.stdout.decode())  # bold is struck twice

    def test_the_program_and_each_verb_have_a_page(self):
        names = {"candela.1", *(f"candela-{verb}.1" for verb in self.verbs())}
        self.assertEqual(set(self.pages()), names)
        self.assertGreater(len(names), 10)

    def test_a_page_says_what_the_long_help_says(self):
        blanks = re.compile(r"\s+")
        for name, page in self.pages().items():
            verb = name[len("candela-") : -len(".1")] if "-" in name else None
            text = blanks.sub(" ", self.read(page))
            words = self.succeeds(*([verb] if verb else []), "--help", "all").out
            for option, what in re.findall(r"^ +((?:-\w,)?--[a-z-]+)[^\n]*?  +(\S[^\n]*)$", words, re.MULTILINE):
                self.assertIn(option.replace(",", ", "), text)
                self.assertIn(blanks.sub(" ", what.strip()), text, name)
            for example in re.findall(r"^  (candela [^\n]*)$", words, re.MULTILINE):
                self.assertIn(blanks.sub(" ", example.strip()), text, name)
            self.assertIn("130 stopped by Ctrl-C", text)
            self.assertIn(f"candela{'-' + verb if verb else ''} - ", text)

    def test_a_page_is_clean_roff(self):
        if not shutil.which("mandoc"):
            self.skipTest("mandoc is not installed")
        for page in self.pages().values():
            done = subprocess.run(["mandoc", "-T", "lint", "-W", "warning", str(page)], stdout=subprocess.PIPE, check=False)
            # Pages have the program's version in place of a date, so that equal sources give equal bytes.
            told = [line for line in done.stdout.decode().splitlines() if "missing date" not in line]
            self.assertEqual(told, [])
            # A hyphen without a backslash is one of typography, which no shell takes for an option's.
            for line in page.read_text().splitlines():
                if not line.startswith((".TH", '.\\"')):
                    self.assertNotRegex(line, r"(?<!\\)-")

    def test_pages_are_the_same_bytes_each_time_and_replace_older_ones(self):
        first = {name: path.read_bytes() for name, path in self.pages().items()}
        (self.folder / "man1/candela.1").write_text("old")
        self.assertEqual({name: path.read_bytes() for name, path in self.pages().items()}, first)

    def test_where_no_page_can_be_written_there_is_one_line_and_no_file(self):
        (self.folder / "file").write_text("")
        self.fails("completion", "man", "-o", "file", says="file")
        self.fails("completion", "man", "-o", "/proc/nowhere", says="/proc/nowhere")
        (self.folder / "man1/candela-view.1").mkdir(parents=True)
        self.fails("completion", "man", "-o", "man1", says="candela-view.1")


if __name__ == "__main__":
    candela.main()
