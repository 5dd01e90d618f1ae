# SPDX-License-Identifier: Apache-2.0
# Five kinds of work, three sets of values: removal, and shorts.
set terminal svg size 860,640 font "sans,12" background rgb "white"
set output out
set style data histograms
set style histogram clustered gap 1
set style fill solid 0.9 noborder
set border 3 lc rgb "#66727e"
set grid ytics lc rgb "#d5dbe1"
set tics nomirror
set xrange [-0.6:4.6]
set key outside top center horizontal
set multiplot layout 2,1
set lmargin 10
set xtics scale 0
set ylabel "removal, share of the tuned one's"
set yrange [0:*]
plot data using 2:xtic(1) lc rgb "#8a97a5" title "fixed", \
     "" using 3 lc rgb "#1f5f9e" title "tuned", \
     "" using 4 lc rgb "#e0a02a" title "adaptive"
set ylabel "1 + shorts a minute"
set yrange [1:*]
set logscale y
plot data using 5:xtic(1) lc rgb "#8a97a5" notitle, \
     "" using 6 lc rgb "#1f5f9e" notitle, \
     "" using 7 lc rgb "#e0a02a" notitle
unset multiplot
