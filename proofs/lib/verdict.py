"""What was wrong in a run of writers and readers, by their histories and the servers' logs."""

import collections

from linearizable import faults
from second_opinion import second_opinion


def judged(traffic, kept, logs, folder):
    """Returns how often each kind of fault is in the histories, and all problems as sentences. Prints what the search says."""
    found = faults(traffic.writes, traffic.reads, kept)
    kinds = collections.Counter(kind for kind, _ in found)
    problems = [f"{kind} ({kinds[kind]} times): {next(text for other, text in found if other == kind)}" for kind in kinds]
    problems += [f"{count} times: {answer}" for answer, count in traffic.unexpected.most_common(10)]
    for log in logs:
        if "panicked" in (words := log.read_text(errors="replace")):
            problems.append(f"{log.name}: {words[max(0, words.index('panicked') - 200):][:1000]}")
    problems += traffic.crashes
    searched = second_opinion(traffic.writes, traffic.reads, kept, folder)
    if searched is None:
        print("the search: left out, for cargo is not here")
        return kinds, problems
    said, is_wrong, left_out = searched
    print(f"the search: {said.splitlines()[-1]}; {left_out} operations in parts that are too long for it")
    return kinds, problems + ([f"the search: {said[:2000]}"] if is_wrong else [])
