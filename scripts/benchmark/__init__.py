"""liftmesh beside the programs a Python user could install instead: time, memory and exactness.

A case is one input and who takes part. Every contestant, a peer on a number of threads, gets a
fresh process. Its first run tells time and memory, and its triangles are checked exactly before
they count. Then all are timed in alternating rounds.

    cases         what a profile measures
    contest       one case: trials, then rounds
    contestants   a peer on a number of threads, and the process it runs in
    peers         the programs and how each is called
    worker        what runs in the process of a Python peer; cgal/ is the same in C++
    process       a line to a process and its answer, with a bound on the time
    results       medians, ratios, the best exact peer
    targets       what is to be reached
    tables, records, plots   what was found, to read, to keep and to see
    startup       what importing costs
    system_load   what else kept the processors busy
"""
