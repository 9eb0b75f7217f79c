# Prints a sphere of radius 1 as an OBJ with vertex colours: awk -f sphere.awk >sphere.obj
BEGIN {
    pi = atan2(0, -1); columns = 96; rows = 48
    for (row = 0; row <= rows; ++row) for (column = 0; column < columns; ++column) {
        polar = pi * row / rows; turn = 2 * pi * column / columns
        x = sin(polar) * sin(turn); y = cos(polar); z = sin(polar) * cos(turn)
        printf "v %.6f %.6f %.6f 0.85 0.42 0.25\nvn %.6f %.6f %.6f\n", x, y, z, x, y, z
    }
    for (row = 0; row < rows; ++row) for (column = 0; column < columns; ++column) {
        a = row * columns + column + 1; b = row * columns + (column + 1) % columns + 1
        c = b + columns; d = a + columns
        if (row > 0) print "f " a "//" a " " c "//" c " " b "//" b
        if (row < rows - 1) print "f " a "//" a " " d "//" d " " c "//" c
    }
}
