"""Error against run time on ordinary, stiff and extreme scenes: what ``integrable report`` does.

A study is a list of rows (:mod:`.plan`), each one scene × method × setting, every method from the same doubles
(:mod:`.doubles`), measured in a worker process (:mod:`.measure`) under a time limit (:mod:`.runner`) and kept in a file
of its own (:mod:`.store`), so that a study that was killed goes on where it was, and two at once share the work.
:mod:`.findings` says what the rows show, :mod:`.figures` and :mod:`.page` show it.
"""
