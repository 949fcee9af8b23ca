"""mutant.py - one planted fault: in a file, a text and what stands there instead"""
import collections

# what: the fault in words. nth: which of several places with the text, from 0 on; None where there is one. at: the place
# itself, of mutants that a program finds. tests: names of those that are run first. same: why no test can tell. needs: the
# processor's feature, as processor_features() of mutants.py spells it, without which the text is not compiled. point: what the text was put
# right for (table_faults.py): then the mutant's own tests alone are to catch it.
Mutant = collections.namedtuple("Mutant", "file old new what nth at tests same sample needs point")
Mutant.__new__.__defaults__ = (None, None, (), None, False, None, None)


def group(file, *mutants):
    """The mutants of one file: text, what stands there instead, what that means, then what else a Mutant has."""
    return [Mutant(file, m[0], m[1], m[2], **(m[3] if len(m) > 3 else {})) for m in mutants]
