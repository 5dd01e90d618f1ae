# SPDX-License-Identifier: Apache-2.0
# One jump over one line, over lines of 0.1 mm with a stop at each, and over the
# same lines looked ahead.
set terminal svg size 760,420 font "sans,12" background rgb "white"
set output out
set xlabel "time, s"
set ylabel "speed along the path, mm/s"
set grid
set key bottom right
plot data index 0 using 1:3 with lines lw 5 lc rgb "#c0d0e8" title "one line", \
     data index 2 using 1:3 with lines lw 1.5 lc rgb "#1f4e9c" title "0.1 mm lines, passed", \
     data index 1 using 1:3 with lines lw 1 lc rgb "#c03030" title "0.1 mm lines, stopped at"
