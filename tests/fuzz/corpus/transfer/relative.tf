# skull
relative
0.1 0 0 0 0
0.5 1 .5 0 0.25
1 1 1 1 1
