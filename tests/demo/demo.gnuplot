# Draws demo.png from what the demo's judge wrote. Needs the variable `frame`.
set terminal pngcairo size 1600,1180 font "DejaVu Sans,12" background rgb "white"
set output "demo.png"
set multiplot layout 2,2 margins 0.055,0.985,0.065,0.955 spacing 0.065,0.10

unset key; unset border; unset tics
set size ratio -1
set title sprintf("frame %d as recorded: the rolling shutter bends it", frame)
plot "before.jpg" binary filetype=jpg with rgbimage
set title sprintf("frame %d as written: rectified, steady, zoomed as little as needed", frame)
plot "after.jpg" binary filetype=jpg with rgbimage

set border 3; set tics nomirror; set grid lc rgb "#dddddd"
set size noratio
set key top left reverse Left
set title "where the camera points (grey: recorded, colour: written)"
set xlabel "seconds"; set ylabel "degrees"
plot "path.dat" using 1:2 with lines lc rgb "#bbbbbb" notitle, \
     "path.dat" using 1:3 with lines lc rgb "#bbbbbb" notitle, \
     "path.dat" using 1:4 with lines lc rgb "#bbbbbb" notitle, \
     "path.dat" using 1:5 with lines lw 2 lc rgb "#d95f02" title "pitch", \
     "path.dat" using 1:6 with lines lw 2 lc rgb "#1b9e77" title "yaw", \
     "path.dat" using 1:7 with lines lw 2 lc rgb "#7570b3" title "roll"

set title "rolling-shutter error of each row, against a camera that has none"
set xlabel "row of the picture"; set ylabel "mean over all frames, px"
set yrange [0:*]
set key top center
plot "rows.dat" using 1:2 with linespoints pt 7 ps 0.6 lw 2 lc rgb "#999999" title "recorded", \
     "rows.dat" using 1:3 with linespoints pt 7 ps 0.6 lw 2 lc rgb "#1b9e77" title "written"
unset multiplot
