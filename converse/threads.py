"""Threads that take calls: as much of concurrent.futures as growth.py needs.  To import that one
takes longer than many a search."""

import threading
from queue import SimpleQueue


class Call:
    """A call that a thread makes: a concurrent.futures.Future, as far as it is used here."""

    def __init__(self, function, arguments, ended):
        self._call, self._tell, self._ended = (function, arguments), ended, threading.Event()
        self._value = self._error = None

    def make(self):
        function, arguments = self._call
        try:
            self._value = function(*arguments)
        except BaseException as error:      # of whoever asks for the result
            self._error = error
        self._ended.set()
        self._tell(self)

    def done(self):
        return self._ended.is_set()

    def result(self):
        self._ended.wait()
        if self._error is not None:
            raise self._error
        return self._value

    def cancel(self):
        """A call that was begun is not ended."""
        return False


class Threads:
    """At most so many, each started when all before it are busy; they call ended(call) at the end
    of each call.  They are daemons: if an exception keeps shutdown from waking them, the process
    does not wait for them."""

    def __init__(self, most, ended):
        self.most, self.ended = most, ended
        self.calls, self.unfinished, self.threads = SimpleQueue(), [], []

    def submit(self, function, *arguments):
        """A Call.  RuntimeError: a thread is needed for it and cannot be had."""
        call = Call(function, arguments, self.ended)
        self.unfinished = [other for other in self.unfinished if not other.done()] + [call]
        if len(self.threads) < min(self.most, len(self.unfinished)):
            thread = threading.Thread(target=self._work, daemon=True)
            thread.start()
            self.threads.append(thread)
        self.calls.put(call)
        return call

    def _work(self):
        for call in iter(self.calls.get, None):
            call.make()
            del call                        # what it holds is not kept while the thread waits

    def shutdown(self):
        for _ in self.threads:
            self.calls.put(None)
        for thread in self.threads:
            thread.join()
