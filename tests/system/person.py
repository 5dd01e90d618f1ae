# SPDX-License-Identifier: Apache-2.0
"""A person who answers edmctl's questions, by rules that a test gives."""
import os
import re
import sys
import time
import subprocess
import threading


LIMIT_S = 600


class Stuck(Exception):
    """A question for which there is no rule, or none any more."""


class Person:
    """@rules: (regular expression, answer) in order; the first that is found in
    the question counts.  An answer is a text, or a function of the match."""

    def __init__(self, command, rules, **more):
        self.rules, self.asked = rules, []
        self.p = subprocess.Popen(
            [str(word) for word in command], stdin=subprocess.PIPE,
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **more)
        self.out = ""
        self.reader = threading.Thread(target=self.read_out)
        self.reader.start()

    def read_out(self):
        for line in self.p.stdout:
            self.out += line

    def question(self):
        """All that is printed until the next question; None: it has ended."""
        text = ""
        while True:
            c = self.p.stderr.read(1)
            if not c:
                self.asked.append(text)
                return None
            text += c
            if text.endswith("]: "):
                return text

    def answer(self, question):
        for rule, answer in self.rules:
            match = re.search(rule, question)
            if match:
                return answer(match) if callable(answer) else answer
        raise Stuck(question)

    def run(self):
        """To its end; the exit code.  What hangs is ended."""
        late = threading.Timer(LIMIT_S, self.p.kill)
        late.start()
        try:
            while (question := self.question()) is not None:
                answer = self.answer(question)
                if self.asked.count(question + answer) > 20:
                    raise Stuck(question)
                self.asked.append(question + answer)
                if os.environ.get("EDM_TALK"):
                    print(time.monotonic(), question + answer, file=sys.__stderr__, flush=True)
                self.p.stdin.write(answer + "\n")
                self.p.stdin.flush()
        except BaseException:
            self.p.kill()
            raise
        finally:
            late.cancel()
            self.p.wait()
            self.reader.join()
        return self.p.returncode

    def told(self):
        return "\n".join(self.asked) + self.out
