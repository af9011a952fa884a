"""G-code programs for measurements: written to a file, with the number of lines that run."""


def lines(path, count):
    """Short G1 lines."""
    with open(path, "w", encoding="ascii") as f:
        f.write("G21 G90 F1000\n")
        for i in range(count):
            f.write(f"G1 X{i % 200}.{i % 1000:03d} Y{i % 150}.{i * 7 % 1000:03d} Z-{i % 5}.{i % 10}\n")
        f.write("M2\n")
    return count


def arcs(path, count):
    """Arcs and helices, by centre and by radius."""
    with open(path, "w", encoding="ascii") as f:
        f.write("G21 G90 F1000\nG0 X0 Y0 Z0\n")
        for i in range(count // 4):
            r, z = 5 + i % 50, i % 7
            f.write(f"G2 X{2 * r} Y0 I{r} J0\nG3 X0 Y0 I-{r} J0 Z-{z}.125\nG2 X{r}.5 Y{r}.5 R{r}.5\nG3 X0 Y0 Z-{z}.5 R{r}.5 P2\n")
        f.write("M2\n")
    return count


def loops(path, count):
    """Loops in loops; `count` expressions are computed."""
    outer = count // 5000
    with open(path, "w", encoding="ascii") as f:
        f.write(f"""G21 G90 F1000
#1=0
o1 while [#1 lt {outer}]
  #2=0
  o2 while [#2 lt 1000]
    #3=[#1*2.5+#2/4-1]
    #<s>=[#3*#3+abs[#2-500]]
    o3 if [#<s> gt 1000000000]
    o3 elseif [#2 mod 100 eq 50]
      G1 X#2 Y[#1/10]
    o3 endif
    #2=[#2+1]
  o2 endwhile
  #1=[#1+1]
o1 endwhile
M2
""")
    return outer * (4 + 1000 * 8)


def calls(path, count):
    """Sub calls with arguments."""
    with open(path, "w", encoding="ascii") as f:
        f.write(f"""G21 G90 F1000
o<step> sub
  #4=[#1+#2]
  G1 X#4 Y#3
o<step> endsub
#10=0
o1 repeat [{count}]
  o<step> call [#10] [2.5] [#10/4]
  #10=[#10+1]
o1 endrepeat
M2
""")
    return count * 6


def many_subs(path, count):
    """100 000 calls of the last of many subs."""
    with open(path, "w", encoding="ascii") as f:
        for i in range(count):
            f.write(f"o<sub{i}> sub\n#5=#1\no<sub{i}> endsub\n")
        f.write(f"o1 repeat [100000]\no<sub{count - 1}> call [1]\no1 endrepeat\nM2\n")
    return 400000


def many_parameters(path, count):
    """600 000 readings and settings among many named parameters."""
    with open(path, "w", encoding="ascii") as f:
        f.write("".join(f"#<p{i}>={i}\n#<_g{i}>={i}\n" for i in range(count)))
        f.write(f"o1 repeat [200000]\n#<p0>=[#<p{count - 1}>+1]\n#<_g0>=[#<p{count // 2}>+#<_g{count - 1}>]\no1 endrepeat\nM2\n")
    return 600000
