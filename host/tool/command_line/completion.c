/* completion.c - texts are printed in single quotes, so that the shell takes them as they are */
#include "completion.h"

#include "exit_status.h"
#include "failure.h"
#include "field.h"

#include <string.h>

/* The names of the analytic fields, with blanks between. */
static void print_fields(FILE *out) {
    for (const field *f = fields; f->name; f++) fprintf(out, "%s%s", f == fields ? "" : " ", f->name);
}

static void print_choices(const option_view *o, FILE *out) {
    for (int n = 0; o->choices(n); n++) fprintf(out, "%s%s", n ? " " : "", o->choices(n));
}

/* ------------------------------------------------------------------------------------------------------------ bash */

static void bash_options(const completion_command *c, FILE *out) {
    option_view o;
    fprintf(out, "    %s) options='", c->name);
    for (size_t n = 0; options_view(c->bit, n, &o); n++)
        fprintf(out, "%s%s%s%s", n ? " " : "", o.short_name ? o.short_name : "", o.short_name ? " " : "", o.name);
    fputs("' ;;\n", out);
}

/* What may follow each option that takes a value: one of a choice, a file, or a value that cannot be completed. */
static void bash_values(const completion_command *c, FILE *out) {
    option_view o;
    for (size_t n = 0; options_view(c->bit, n, &o); n++) {
        if (!o.value) continue;
        fprintf(out, "    '%s %s'", c->name, o.name);
        if (o.short_name) fprintf(out, " | '%s %s'", c->name, o.short_name);
        fputs(") ", out);
        if (o.choices) {
            fputs("words='", out);
            print_choices(&o, out);
            fputs("' ;;\n", out);
        } else {
            fprintf(out, "%s ;;\n", o.takes_file ? "files=1" : "return");
        }
    }
}

static void bash_print(const completion_command *commands, size_t count, FILE *out) {
    fputs("# bash completion of tetracubes, made by: tetracubes --completion bash\n"
          "_tetracubes() {\n"
          "    local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]} words='' files='' "
          "options=''\n"
          "    COMPREPLY=()\n"
          "    [ \"$current\" != = ] || current=''\n"
          "    [ \"$previous\" != = ] || previous=${COMP_WORDS[COMP_CWORD - 2]}\n"
          "    if [ \"$COMP_CWORD\" -eq 1 ]; then\n"
          "        mapfile -t COMPREPLY < <(compgen -W '",
          out);
    for (size_t n = 0; n < count; n++) fprintf(out, "%s ", commands[n].name);
    fputs("--help --version --completion' -- \"$current\")\n"
          "        return\n"
          "    fi\n"
          "    case ${COMP_WORDS[1]} in\n",
          out);
    for (size_t n = 0; n < count; n++) bash_options(&commands[n], out);
    fputs("    --completion) options='bash zsh' ;;\n"
          "    esac\n"
          "    case \"${COMP_WORDS[1]} $previous\" in\n",
          out);
    for (size_t n = 0; n < count; n++) bash_values(&commands[n], out);
    fputs("    '--completion '*) words=$options ;;\n"
          "    'generate generate') words='",
          out);
    print_fields(out);
    fputs("' ;;\n"
          "    *) files=1 ;;\n"
          "    esac\n"
          "    case $current in\n"
          "    -*) words=$options ;;\n"
          "    *) [ -z \"$files\" ] || mapfile -t COMPREPLY < <(compgen -f -- \"$current\") ;;\n"
          "    esac\n"
          "    [ -z \"$words\" ] || mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$current\")\n"
          "}\n"
          "complete -o filenames -F _tetracubes tetracubes\n",
          out);
}

/* ------------------------------------------------------------------------------------------------------------- zsh */

/* The first line of a help text, with what _arguments would take as its own escaped. */
static void zsh_help(const char *text, FILE *out) {
    for (; *text && *text != '\n'; text++) {
        if (strchr("[]:\\", *text)) fputc('\\', out);
        if (*text == '\'')
            fputs("'\\''", out);
        else
            fputc(*text, out);
    }
}

static void zsh_option(const option_view *o, const char *name, const char *joint, FILE *out) {
    fprintf(out, "            '%s%s[", name, o->value ? joint : "");
    zsh_help(o->help, out);
    fputc(']', out);
    if (o->value) {
        fputc(':', out);
        zsh_help(o->value, out);
        fputc(':', out);
        if (o->choices) {
            fputc('(', out);
            print_choices(o, out);
            fputc(')', out);
        } else if (o->takes_file) {
            fputs("_files", out);
        }
    }
    fputs("' \\\n", out);
}

static void zsh_command(const completion_command *c, FILE *out) {
    option_view o;
    fprintf(out, "    %s)\n        _arguments \\\n", c->name);
    for (size_t n = 0; options_view(c->bit, n, &o); n++) {
        zsh_option(&o, o.name, "=", out);
        if (o.short_name) zsh_option(&o, o.short_name, "", out);
    }
    if (c->bit == COMMAND_GENERATE) {
        fputs("            '1:field:(", out);
        print_fields(out);
        fputs(")'\n        ;;\n", out);
    } else {
        fputs("            '*:input:_files'\n        ;;\n", out);
    }
}

static void zsh_print(const completion_command *commands, size_t count, FILE *out) {
    fputs("#compdef tetracubes\n"
          "# zsh completion of tetracubes, made by: tetracubes --completion zsh\n"
          "_tetracubes() {\n"
          "    local -a commands=(\n",
          out);
    for (size_t n = 0; n < count; n++) {
        fprintf(out, "        '%s:", commands[n].name);
        zsh_help(commands[n].summary, out);
        fputs("'\n", out);
    }
    fputs("        '--help:what there is'\n"
          "        '--version:version and file formats'\n"
          "        '--completion:a script for bash or zsh'\n"
          "    )\n"
          "    if (( CURRENT == 2 )); then\n"
          "        _describe command commands\n"
          "        return\n"
          "    fi\n"
          "    shift words\n"
          "    (( CURRENT-- ))\n"
          "    case $words[1] in\n",
          out);
    for (size_t n = 0; n < count; n++) zsh_command(&commands[n], out);
    fputs("    --completion)\n"
          "        _values shell bash zsh\n"
          "        ;;\n"
          "    esac\n"
          "}\n"
          "if [[ $zsh_eval_context[-1] == loadautofunc ]]; then\n"
          "    _tetracubes \"$@\"\n"
          "else\n"
          "    compdef _tetracubes tetracubes\n"
          "fi\n",
          out);
}

int completion_print(const char *shell, const completion_command *commands, size_t count, FILE *out) {
    if (strcmp(shell, "bash") == 0)
        bash_print(commands, count, out);
    else if (strcmp(shell, "zsh") == 0)
        zsh_print(commands, count, out);
    else
        return fail(STATUS_USAGE, "--completion: '%.40s' is neither bash nor zsh", shell);
    return 0;
}
