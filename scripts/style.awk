# The rules of scripts/style; needs file_limit and function_limit.
function report(line, what) {
    print FILENAME ":" line ": " what
    findings++
}
function end_of_file() {
    if (lines > file_limit) {
        print previous ": " lines " lines, allowed are " file_limit
        findings++
    }
}
# Comments and strings leave, so that a word in them is no call.
function code(text,    at) {
    if (in_comment) {
        at = index(text, "*/")
        if (!at)
            return ""
        text = substr(text, at + 2)
        in_comment = 0
    }
    gsub(/\\./, "", text)
    gsub(/"[^"]*"/, "\"\"", text)
    gsub(/\/\*([^*]|\*+[^*\/])*\*+\//, " ", text)
    sub(/\/\/.*/, "", text)
    at = index(text, "/*")
    if (at) {
        in_comment = 1
        text = substr(text, 1, at - 1)
    }
    return text
}
function calls(text, names) {
    return text ~ "(^|[^A-Za-z0-9_>.])(" names ")[ ]*\\("
}
FNR == 1 {
    end_of_file()
    in_comment = 0
    start = 0
    library = FILENAME ~ /^(base|atlas|poses|loaders|render|selection)\//
}
{
    previous = FILENAME
    lines = FNR
    text = code($0)
}
FNR == 2 && FILENAME ~ /[.](c|cpp)$/ && FILENAME !~ /^examples\// && !/^\/[*\/]/ {
    report(FNR, "the file does not open with a comment that says what it is")
}
/^[{]/ || /^[a-z].*[)] [{]$/ { start = FNR }
/^[}]/ && start {
    if (FNR - start > function_limit)
        report(start, (FNR - start) " lines in one function, allowed are " function_limit)
    start = 0
}
calls(text, "strcpy|strcat|sprintf|vsprintf|gets|atoi|atol|atof|strtok|scanf|sscanf|fscanf|alloca|rand|srand") {
    report(FNR, "banned function:" $0)
}
library && calls(text, "exit|_exit|abort|printf|fprintf|vprintf|vfprintf|puts|putchar|perror|system|setlocale") {
    report(FNR, "not in the library:" $0)
}
library && FILENAME != "base/memory.c" &&
    calls(text, "malloc|calloc|realloc|reallocarray|aligned_alloc|posix_memalign|free|strdup|strndup|asprintf") {
    report(FNR, "allocation goes through base/memory.h:" $0)
}
END {
    end_of_file()
    exit findings > 0
}