# SPDX-License-Identifier: Apache-2.0
#
# taper.gp - both contours of taper.csv, as edmsim --pulses wrote it
#
# Back from the guides of wire.ini: U V are relative, the planes 20 and 60 of
# the 100 mm above the lower guide.
set datafile separator ','
set size ratio -1
set terminal svg size 700,500
set output 'taper-path.svg'
set xlabel 'X, mm'
set ylabel 'Y, mm'
plot 'taper.csv' using ($3+$9*0.2)/1000:($4+$10*0.2)/1000 every 10::1 \
	with lines title 'bottom', \
     '' using ($3+$9*0.6)/1000:($4+$10*0.6)/1000 every 10::1 \
	with lines title 'top'
