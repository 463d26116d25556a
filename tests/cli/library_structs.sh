# The structs that the sample in Python repeats are those of the header, field for field: the
# library writes into memory of the size that Python believes they have.
# sanitize: no
cat >list.py <<'END'
import ast
import ctypes
import sys

# The classes of the sample without what it does; the comment behind each says which struct it is.
text = open(sys.argv[1]).read()
tree = ast.parse(text)
tree.body = [part for part in tree.body if isinstance(part, ast.ClassDef)]
names = {part.name: text.splitlines()[part.lineno - 1].split("# ")[1] for part in tree.body}
scope = {"c": ctypes}
exec(compile(tree, sys.argv[1], "exec"), scope)
with open("python.txt", "w") as seen, open("sizes.c", "w") as ask:
    ask.write('#include "glowworm.h"\n#include <stdio.h>\nint main(void)\n{\n')
    for name, struct in names.items():
        print(struct, ctypes.sizeof(scope[name]), file=seen)
        ask.write('printf("%s %%zu\\n", sizeof(%s));\n' % (struct, struct))
        for field, _ in scope[name]._fields_:
            place = getattr(scope[name], field)
            print(" ", field, place.offset, place.size, file=seen)
            ask.write('printf("  %s %%zu %%zu\\n", offsetof(%s, %s), sizeof(((%s *)0)->%s));\n' %
                      (field, struct, field, struct, field))
    ask.write("return 0;\n}\n")
END
python3 list.py "$SOURCE/samples/relight_room.py" || exit
gcc -I"$SOURCE/lib" sizes.c -o sizes && ./sizes >c.txt || exit
diff c.txt python.txt
grep -c '^gw_' c.txt
