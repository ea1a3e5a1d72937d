/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sg_parser.y - syntax of the language; builds the tree of ast.h. docs/language.md is its reference.
 *
 * A name with arguments can begin an expression ("-> f(2) * 3 : A") or be a successor ("-> f(2)"): both share `call`,
 * and what follows decides. Statements begin with keywords, so newlines mean nothing. */
%define api.pure full
%define api.prefix {sg_yy}
%define api.token.prefix {TOKEN_}
%define api.location.type {sg_pos}
%define parse.error custom
%define parse.lac full
%locations
%expect 0
%parse-param {sg_parse *p} {void *scanner}
%lex-param {void *scanner}

%code top {
#include "config.h"
}

%code requires {
#include "grammar/parse_priv.h"
}

%code {
#include <stdio.h>
#include <string.h>

#pragma GCC diagnostic ignored "-Wnull-dereference"
#pragma GCC diagnostic ignored "-Wcast-qual"

/* Long chains that open no bracket (unary minus, powers) end here. */
#define YYMAXDEPTH 5000

/* A thing stands where its first token stands; an empty one where the next token does. */
#define YYLLOC_DEFAULT(current, rhs, n) ((current) = (n) > 0 ? YYRHSLOC(rhs, 1) : p->at)

int sg_yylex(SG_YYSTYPE *value, SG_YYLTYPE *location, void *scanner);
static void sg_yyerror(const sg_pos *at, sg_parse *p, void *scanner, const char *message);

/* End the parse when memory was out, or when something was said already. */
#define NEED(pointer)                                                                                                  \
    do {                                                                                                               \
        if ((pointer) == NULL) {                                                                                       \
            sg_parse_fail_nomem(p);                                                                                    \
            YYABORT;                                                                                                   \
        }                                                                                                              \
    } while (0)
#define CHECK()                                                                                                        \
    do {                                                                                                               \
        if (p->status != SG_OK)                                                                                        \
            YYABORT;                                                                                                   \
    } while (0)
#define OPERATE(result, op, a, b, c, at)                                                                               \
    do {                                                                                                               \
        (result) = operate(p, (op), (a), (b), (c), (at));                                                              \
        CHECK();                                                                                                       \
    } while (0)

static sg_ast_expr *operate(sg_parse *p, sg_operator op, sg_ast_expr *a, sg_ast_expr *b, sg_ast_expr *c, sg_pos at);
static sg_ast_expr *call_expr(sg_parse *p, const sg_ast_item *call);
static void declare_name(sg_parse *p, const char *name, sg_pos at);
static void declare_limit(sg_parse *p, const char *what, double limit, sg_pos at, sg_pos number_at);
static void declare_flag(sg_parse *p, bool *flag, sg_pos *where, const char *word, sg_pos at);
static void declare_start(sg_parse *p, sg_ast_item *call);
static void add_definition(sg_parse *p, const char *name, bool is_function, sg_ast_names params, sg_ast_expr *value,
                           sg_pos at);
static void add_label(sg_parse *p, const char *name, bool has_color, uint32_t color, sg_pos at);
static void add_import(sg_parse *p, const char *name, const char *file, sg_pos at, sg_pos file_at);
static void add_material(sg_parse *p, const char *name, uint32_t color, sg_pos at);
static void add_rule(sg_parse *p, sg_ast_rule head, sg_ast_alternatives alternatives);
static sg_ast_names add_name(sg_parse *p, sg_ast_names list, const char *name, sg_pos at);
static sg_ast_item *block(sg_parse *p, sg_item_kind kind, const char *name, sg_ast_expr *arg, sg_ast_item *items,
                          sg_pos at);
static sg_ast_alternative *alternative(sg_parse *p, sg_ast_expr *weight, sg_ast_item *items, sg_pos at);
static void add_row(sg_parse *p, sg_ast_matrix *m, const sg_ast_matrix *row);
static void set_sizes(sg_parse *p, sg_ast_matrix **slot, sg_ast_matrix *m, const char *word);
}

%union {
    double number;
    uint32_t color;
    const char *name;
    sg_ast_expr *expr;
    sg_ast_exprs exprs;
    sg_ast_names names;
    sg_ast_item *item;
    sg_ast_items items;
    sg_ast_alternative *alternative;
    sg_ast_alternatives alternatives;
    sg_ast_matrix *matrix;
    sg_ast_sizes *sizes;
    sg_ast_rule head;
}

%token GRAMMAR "'grammar'" LIMIT "'limit'" TIED "'tied'" WEIGHTS "'weights'" CONST "'const'" FUNCTION "'function'"
%token IMPORT "'import'"
%token LABEL "'label'" MATERIAL "'material'" START "'start'" RULE "'rule'" IF "'if'" AT "'at'" NOTHING "'nothing'"
%token MAYBE "'maybe'"
%token SPLIT "'split'" REPEAT "'repeat'" COMPONENTS "'components'" SIZES "'sizes'" MEAN "'mean'"
%token COVARIANCE "'covariance'" SD "'sd'" EXAMPLES "'examples'" ARROW "'->'"
%token OR "'or'" AND "'and'" NOT "'not'" LE "'<='" GE "'>='" EQ "'=='" NE "'!='"
%token <number> NUMBER "a number"
%token <color> COLOR "a colour"
%token <name> NAME "a name"
%token YYEOF 0 "the end of the file"

%left OR
%left AND
%right NOT
%nonassoc '<' LE '>' GE EQ NE
%left '+' '-'
%left '*' '/'
%precedence NEGATE
%right '^'

%type <expr> expr argument
%type <exprs> expressions arguments arguments_or_none tuple_rest
%type <names> parameters parameter_list
%type <item> call item split_part face_part body
%type <items> items split_parts face_parts
%type <alternative> alternative
%type <alternatives> alternatives
%type <matrix> vector numbers matrix rows
%type <sizes> sizes
%type <number> signed
%type <head> head

%%

file: %empty | file statement ;

statement:
    GRAMMAR NAME                { declare_name(p, $2, @1); CHECK(); }
  | LIMIT NAME NUMBER           { declare_limit(p, $2, $3, @1, @3); CHECK(); }
  | TIED                        { declare_flag(p, &p->ast->tied, &p->ast->tied_at, "tied", @1); CHECK(); }
  | WEIGHTS                     { declare_flag(p, &p->ast->relative_weights, &p->ast->weights_at, "weights", @1); CHECK(); }
  | CONST NAME '=' expr         { add_definition(p, $2, false, (sg_ast_names){NULL, NULL, 0}, $4, @2); CHECK(); }
  | FUNCTION NAME '(' parameter_list ')' '=' expr
                                { add_definition(p, $2, true, $4, $7, @2); CHECK(); }
  | IMPORT NAME NAME            { add_import(p, $2, $3, @2, @3); CHECK(); }
  | LABEL NAME                  { add_label(p, $2, false, 0, @2); CHECK(); }
  | LABEL NAME COLOR            { add_label(p, $2, true, $3, @2); CHECK(); }
  | MATERIAL NAME COLOR         { add_material(p, $2, $3, @2); CHECK(); }
  | START call                  { declare_start(p, $2); CHECK(); }
  | head alternatives           { add_rule(p, $1, $2); CHECK(); }
  | head IF expr alternatives   { $1.guard = $3; add_rule(p, $1, $4); CHECK(); }
  | head AT LIMIT ARROW body    {
        sg_ast_alternatives one;
        one.first = one.last = alternative(p, NULL, $5, @4);
        CHECK();
        $1.at_limit = true;
        add_rule(p, $1, one);
        CHECK();
    }
  ;

head: RULE NAME parameters      { memset(&$$, 0, sizeof $$); $$.name = $2; $$.params = $3; $$.at = @2; } ;

parameters:
    %empty                      { $$ = (sg_ast_names){NULL, NULL, 0}; }
  | '(' parameter_list ')'      { $$ = $2; }
  ;

parameter_list:
    NAME                        { $$ = add_name(p, (sg_ast_names){NULL, NULL, 0}, $1, @1); CHECK(); }
  | parameter_list ',' NAME     { $$ = add_name(p, $1, $3, @3); CHECK(); }
  ;

alternatives:
    alternative                 { $$.first = $$.last = $1; }
  | alternatives alternative    { $$ = $1; SG_AST_APPEND($$.first, $$.last, $2); }
  ;

alternative:
    ARROW body                  { $$ = alternative(p, NULL, $2, @1); CHECK(); }
  | ARROW expr ':' body         { $$ = alternative(p, $2, $4, @2); CHECK(); }
  ;

body:
    NOTHING                     { $$ = NULL; }
  | items                       { $$ = $1.first; }
  ;

items:
    item                        { $$.first = $$.last = $1; }
  | items item                  { $$ = $1; SG_AST_APPEND($$.first, $$.last, $2); }
  ;

item:
    call
  | NAME '~' call               {
        sg_ast_expr *e = call_expr(p, $3);
        CHECK();
        $$ = block(p, SG_ITEM_DRAW, $1, e, NULL, @1);
        CHECK();
    }
  | '[' body ']'                { $$ = block(p, SG_ITEM_PUSH, NULL, NULL, $2, @1); CHECK(); }
  | MAYBE '(' expr ')' call     { $$ = block(p, SG_ITEM_MAYBE, NULL, $3, $5, @1); CHECK(); }
  | REPEAT NAME expr '{' body '}'
                                { $$ = block(p, SG_ITEM_REPEAT, $2, $3, $5, @1); CHECK(); }
  | COMPONENTS '{' face_parts '}'
                                { $$ = block(p, SG_ITEM_COMPONENTS, NULL, NULL, $3.first, @1); CHECK(); }
  | SPLIT NAME '{' split_parts '}'
                                { $$ = block(p, SG_ITEM_SPLIT, $2, NULL, $4.first, @1); CHECK(); }
  | SPLIT NAME '{' split_parts '}' SIZES sizes
                                { $$ = block(p, SG_ITEM_SPLIT, $2, NULL, $4.first, @1); CHECK(); $$->sizes = $7; }
  ;

call:
    NAME                        { $$ = sg_ast_item_new(p->arena, SG_ITEM_CALL, $1, @1); NEED($$); }
  | NAME '(' arguments_or_none ')' {
        $$ = sg_ast_item_new(p->arena, SG_ITEM_CALL, $1, @1);
        NEED($$);
        $$->parentheses = true;
        $$->args = $3.first;
        $$->nargs = $3.n;
    }
  ;

face_parts:
    face_part                   { $$.first = $$.last = $1; }
  | face_parts '|' face_part    { $$ = $1; SG_AST_APPEND($$.first, $$.last, $3); }
  ;

face_part: NAME ':' body        { $$ = block(p, SG_ITEM_PART, $1, NULL, $3, @1); CHECK(); } ;

split_parts:
    split_part                  { $$.first = $$.last = $1; }
  | split_parts '|' split_part  { $$ = $1; SG_AST_APPEND($$.first, $$.last, $3); }
  ;

split_part:
    body                        { $$ = block(p, SG_ITEM_PART, NULL, NULL, $1, @1); CHECK(); $$->size = SG_SIZE_FLOATING; }
  | expr ':' body               { $$ = block(p, SG_ITEM_PART, NULL, $1, $3, @1); CHECK(); $$->size = SG_SIZE_ABSOLUTE; }
  | '~' expr ':' body           { $$ = block(p, SG_ITEM_PART, NULL, $2, $4, @1); CHECK(); $$->size = SG_SIZE_FLOATING; }
  | '\'' expr ':' body          { $$ = block(p, SG_ITEM_PART, NULL, $2, $4, @1); CHECK(); $$->size = SG_SIZE_RELATIVE; }
  ;

sizes:
    MEAN vector                 { $$ = SG_NEW(p->arena, sg_ast_sizes); NEED($$); $$->at = @1; $$->mean = $2; }
  | EXAMPLES matrix             { $$ = SG_NEW(p->arena, sg_ast_sizes); NEED($$); $$->at = @1; $$->examples = $2; }
  | sizes COVARIANCE matrix     { $$ = $1; set_sizes(p, &$$->covariance, $3, "covariance"); CHECK(); }
  | sizes SD vector             { $$ = $1; set_sizes(p, &$$->sd, $3, "sd"); CHECK(); }
  | sizes EXAMPLES matrix       { $$ = $1; set_sizes(p, &$$->examples, $3, "examples"); CHECK(); }
  ;

matrix:
    '(' ')'                     { $$ = sg_ast_matrix_new(p->arena, @1); NEED($$); }
  | '(' rows ')'                { $$ = $2; $$->at = @1; }
  ;

rows:
    vector                      { $$ = $1; }
  | rows ',' vector             { $$ = $1; add_row(p, $$, $3); CHECK(); }
  ;

vector: '(' numbers ')'         { $$ = $2; $$->at = @1; $$->rows = 1; $$->columns = $$->n; } ;

numbers:
    signed                      { $$ = sg_ast_matrix_new(p->arena, @1); NEED($$);
                                  if (!sg_ast_matrix_add(p->arena, $$, &$1, 1)) NEED(NULL); }
  | numbers ',' signed          { $$ = $1; if (!sg_ast_matrix_add(p->arena, $$, &$3, 1)) NEED(NULL); }
  ;

signed:
    NUMBER
  | '-' NUMBER                  { $$ = -$2; }
  ;

arguments_or_none:
    %empty                      { $$ = (sg_ast_exprs){NULL, NULL, 0}; }
  | arguments
  ;

arguments:
    argument                    { $$ = sg_ast_exprs_add((sg_ast_exprs){NULL, NULL, 0}, $1); }
  | arguments ',' argument      { $$ = sg_ast_exprs_add($1, $3); }
  ;

argument:
    expr
  | COLOR                       { $$ = sg_ast_number(p->arena, $1, @1); NEED($$); $$->kind = SG_AST_COLOR; }
  | '(' expr ',' tuple_rest ')' {
        sg_ast_exprs list = sg_ast_exprs_add((sg_ast_exprs){NULL, NULL, 0}, $2);
        list.last->next = $4.first;
        list.n += $4.n;
        $$ = sg_ast_named(p->arena, SG_AST_TUPLE, NULL, list, @1);
        NEED($$);
    }
  ;

tuple_rest: expressions ;

expressions:
    expr                        { $$ = sg_ast_exprs_add((sg_ast_exprs){NULL, NULL, 0}, $1); }
  | expressions ',' expr        { $$ = sg_ast_exprs_add($1, $3); }
  ;

expr:
    NUMBER                      { $$ = sg_ast_number(p->arena, $1, @1); NEED($$); }
  | call                        { $$ = call_expr(p, $1); CHECK(); }
  | '(' expr ')'                { $$ = $2; }
  | IF '(' expr ',' expr ',' expr ')'
                                { OPERATE($$, SG_E_IF, $3, $5, $7, @1); }
  | expr OR expr                { OPERATE($$, SG_E_OR, $1, $3, NULL, @1); }
  | expr AND expr               { OPERATE($$, SG_E_AND, $1, $3, NULL, @1); }
  | NOT expr                    { OPERATE($$, SG_E_NOT, $2, NULL, NULL, @1); }
  | expr '<' expr               { OPERATE($$, SG_E_LT, $1, $3, NULL, @1); }
  | expr LE expr                { OPERATE($$, SG_E_LE, $1, $3, NULL, @1); }
  | expr '>' expr               { OPERATE($$, SG_E_GT, $1, $3, NULL, @1); }
  | expr GE expr                { OPERATE($$, SG_E_GE, $1, $3, NULL, @1); }
  | expr EQ expr                { OPERATE($$, SG_E_EQ, $1, $3, NULL, @1); }
  | expr NE expr                { OPERATE($$, SG_E_NE, $1, $3, NULL, @1); }
  | expr '+' expr               { OPERATE($$, SG_E_ADD, $1, $3, NULL, @1); }
  | expr '-' expr               { OPERATE($$, SG_E_SUB, $1, $3, NULL, @1); }
  | expr '*' expr               { OPERATE($$, SG_E_MUL, $1, $3, NULL, @1); }
  | expr '/' expr               { OPERATE($$, SG_E_DIV, $1, $3, NULL, @1); }
  | expr '^' expr               { OPERATE($$, SG_E_POW, $1, $3, NULL, @1); }
  | '-' expr %prec NEGATE       { OPERATE($$, SG_E_NEG, $2, NULL, NULL, @1); }
  ;

%%

void sg_parse_fail(sg_parse *p, sg_pos at, const char *format, ...)
{
    if (p->status != SG_OK)
        return;
    char sentence[480];
    va_list ap;
    va_start(ap, format);
    vsnprintf(sentence, sizeof sentence, format, ap);
    va_end(ap);
    p->status = sg_source_fail(&p->source, at, p->err, "%s", sentence);
}

void sg_parse_fail_nomem(sg_parse *p)
{
    if (p->status == SG_OK)
        p->status = SG_FAIL_NOMEM(p->err);
}

/* Called for "memory exhausted" only: syntax errors go through yyreport_syntax_error(). The parser's stack is at its
 * limit, unless so few tokens were read that it cannot be. */
static void sg_yyerror(const sg_pos *at, sg_parse *p, void *scanner, const char *message)
{
    (void)scanner;
    (void)message;
    if (p->ntokens < YYMAXDEPTH / 4)
        sg_parse_fail_nomem(p);
    else
        sg_parse_fail(p, *at, "nested too deep");
}

static sg_ast_expr *operate(sg_parse *p, sg_operator op, sg_ast_expr *a, sg_ast_expr *b, sg_ast_expr *c, sg_pos at)
{
    sg_ast_expr *e = sg_ast_operate(p->arena, op, a, b, c, at);
    if (e == NULL)
        sg_parse_fail_nomem(p);
    else if (e->height > SG_MAX_HEIGHT)
        sg_parse_fail(p, at, "an expression of more than %d levels", SG_MAX_HEIGHT);
    return e;
}

static sg_ast_expr *call_expr(sg_parse *p, const sg_ast_item *call)
{
    const sg_operator op = call->parentheses ? sg_operator_find(call->name) : SG_E_COUNT;
    const sg_ast_kind kind = op != SG_E_COUNT ? SG_AST_OPERATOR : call->parentheses ? SG_AST_CALL : SG_AST_NAME;
    const sg_ast_exprs args = {call->args, NULL, call->nargs};
    if (op != SG_E_COUNT && call->nargs != sg_operator_get(op)->arity) {
        sg_parse_fail(p, call->at, "%s takes %u argument%s, not %u", call->name, sg_operator_get(op)->arity,
                      sg_operator_get(op)->arity == 1 ? "" : "s", call->nargs);
        return NULL;
    }
    sg_ast_expr *e = sg_ast_named(p->arena, kind, call->name, args, call->at);
    if (e == NULL)
        sg_parse_fail_nomem(p);
    else if (e->height > SG_MAX_HEIGHT)
        sg_parse_fail(p, e->at, "an expression of more than %d levels", SG_MAX_HEIGHT);
    else
        e->op = op;
    return e;
}

static void declare_name(sg_parse *p, const char *name, sg_pos at)
{
    if (p->ast->name != NULL)
        sg_parse_fail(p, at, "a second 'grammar': the name was given in line %u", p->ast->name_at.line);
    p->ast->name = name;
    p->ast->name_at = at;
}

static void declare_limit(sg_parse *p, const char *what, double limit, sg_pos at, sg_pos number_at)
{
    if (strcmp(what, "depth") != 0)
        sg_parse_fail(p, at, "found 'limit %.60s'; expected 'limit depth'", what);
    else if (p->ast->has_limit)
        sg_parse_fail(p, at, "a second 'limit depth': the first is in line %u", p->ast->limit_at.line);
    else if (!(limit >= 0 && limit <= 1e6) || limit != (double)(size_t)limit)
        sg_parse_fail(p, number_at, "the depth limit must be a whole number from 0 to 1000000");
    else
        p->ast->limit = (size_t)limit;
    p->ast->has_limit = true;
    p->ast->limit_at = at;
}

static void declare_flag(sg_parse *p, bool *flag, sg_pos *where, const char *word, sg_pos at)
{
    if (*flag)
        sg_parse_fail(p, at, "a second '%s': the first is in line %u", word, where->line);
    *flag = true;
    *where = at;
}

static void declare_start(sg_parse *p, sg_ast_item *call)
{
    if (p->ast->start != NULL)
        sg_parse_fail(p, call->at, "a second 'start': the first is in line %u", p->ast->start->at.line);
    p->ast->start = call;
}

static void add_definition(sg_parse *p, const char *name, bool is_function, sg_ast_names params, sg_ast_expr *value,
                           sg_pos at)
{
    sg_ast_definition *d = SG_NEW(p->arena, sg_ast_definition);
    if (d == NULL) {
        sg_parse_fail_nomem(p);
        return;
    }
    *d = (sg_ast_definition){name, is_function, params, value, at, NULL};
    SG_AST_APPEND(p->ast->definitions, p->ast->last_definition, d);
}

static void add_label(sg_parse *p, const char *name, bool has_color, uint32_t color, sg_pos at)
{
    sg_ast_label *l = SG_NEW(p->arena, sg_ast_label);
    if (l == NULL) {
        sg_parse_fail_nomem(p);
        return;
    }
    *l = (sg_ast_label){name, has_color, color, at, NULL};
    SG_AST_APPEND(p->ast->labels, p->ast->last_label, l);
}

static void add_import(sg_parse *p, const char *name, const char *file, sg_pos at, sg_pos file_at)
{
    sg_ast_import *i = SG_NEW(p->arena, sg_ast_import);
    if (i == NULL) {
        sg_parse_fail_nomem(p);
        return;
    }
    *i = (sg_ast_import){name, file, at, file_at, NULL};
    SG_AST_APPEND(p->ast->imports, p->ast->last_import, i);
}

static void add_material(sg_parse *p, const char *name, uint32_t color, sg_pos at)
{
    sg_ast_label *m = SG_NEW(p->arena, sg_ast_label);
    if (m == NULL) {
        sg_parse_fail_nomem(p);
        return;
    }
    *m = (sg_ast_label){name, true, color, at, NULL};
    SG_AST_APPEND(p->ast->materials, p->ast->last_material, m);
}

static void add_rule(sg_parse *p, sg_ast_rule head, sg_ast_alternatives alternatives)
{
    sg_ast_rule *r = SG_NEW(p->arena, sg_ast_rule);
    if (r == NULL) {
        sg_parse_fail_nomem(p);
        return;
    }
    *r = head;
    r->alternatives = alternatives.first;
    SG_AST_APPEND(p->ast->rules, p->ast->last_rule, r);
}

static sg_ast_names add_name(sg_parse *p, sg_ast_names list, const char *name, sg_pos at)
{
    sg_ast_name *n = SG_NEW(p->arena, sg_ast_name);
    if (n == NULL) {
        sg_parse_fail_nomem(p);
        return list;
    }
    n->name = name;
    n->at = at;
    SG_AST_APPEND(list.first, list.last, n);
    list.n++;
    return list;
}

static sg_ast_item *block(sg_parse *p, sg_item_kind kind, const char *name, sg_ast_expr *arg, sg_ast_item *items,
                          sg_pos at)
{
    sg_ast_item *item = sg_ast_item_new(p->arena, kind, name, at);
    if (item == NULL) {
        sg_parse_fail_nomem(p);
        return NULL;
    }
    item->args = arg;
    item->nargs = arg != NULL;
    item->items = items;
    return item;
}

static sg_ast_alternative *alternative(sg_parse *p, sg_ast_expr *weight, sg_ast_item *items, sg_pos at)
{
    sg_ast_alternative *a = SG_NEW(p->arena, sg_ast_alternative);
    if (a == NULL)
        sg_parse_fail_nomem(p);
    else
        *a = (sg_ast_alternative){weight, items, at, NULL};
    return a;
}

static void add_row(sg_parse *p, sg_ast_matrix *m, const sg_ast_matrix *row)
{
    if (row->columns != m->columns)
        sg_parse_fail(p, row->at, "this row has %zu numbers, the first one has %zu", row->columns, m->columns);
    else if (!sg_ast_matrix_add(p->arena, m, row->values, row->n))
        sg_parse_fail_nomem(p);
    else
        m->rows++;
}

static void set_sizes(sg_parse *p, sg_ast_matrix **slot, sg_ast_matrix *m, const char *word)
{
    if (*slot != NULL)
        sg_parse_fail(p, m->at, "a second '%s' of these sizes", word);
    *slot = m;
}

/* Sets of tokens that stand for one thing in a reader's mind: they are named at once when all of them are expected. */
typedef struct {
    const char *name;
    const char *tokens[14]; /* names, NULL at the end */
} token_group;

static const token_group groups[] = {
    {"an expression", {"a number", "a name", "'('", "'-'", "'not'", "'if'"}},
    {"a successor or operation", {"a name", "'['", "'maybe'", "'repeat'", "'components'", "'split'"}},
    {"an operator", {"'or'", "'and'", "'<'", "'<='", "'>'", "'>='", "'=='", "'!='", "'+'", "'-'", "'*'", "'/'", "'^'"}},
    {"a statement",
     {"'grammar'", "'limit'", "'tied'", "'weights'", "'const'", "'function'", "'label'", "'material'", "'start'", "'rule'",
      "'import'"}},
};

enum { NGROUPS = sizeof groups / sizeof *groups, MAX_EXPECTED = 64 };

static int find_expected(const char *name, const yysymbol_kind_t *expected, int n)
{
    for (int i = 0; i < n; i++)
        if (strcmp(yysymbol_name(expected[i]), name) == 0)
            return i;
    return -1;
}

/* Mark the tokens of a group as covered when all of them are expected. */
static bool cover(const token_group *group, const yysymbol_kind_t *expected, int n, bool *covered)
{
    for (int i = 0; i < 14 && group->tokens[i] != NULL; i++)
        if (find_expected(group->tokens[i], expected, n) < 0)
            return false;
    for (int i = 0; i < 14 && group->tokens[i] != NULL; i++)
        covered[find_expected(group->tokens[i], expected, n)] = true;
    return true;
}

static void add_word(char *list, size_t size, const char *word, bool last)
{
    const size_t n = strlen(list);
    snprintf(list + n, size - n, "%s%s", n == 0 ? "" : last ? " or " : ", ", word);
}

static void list_expected(const yypcontext_t *context, char *list, size_t size)
{
    yysymbol_kind_t expected[MAX_EXPECTED];
    bool covered[MAX_EXPECTED] = {false};
    const char *words[MAX_EXPECTED + NGROUPS];
    int nwords = 0;
    const int n = yypcontext_expected_tokens(context, expected, MAX_EXPECTED);
    for (int i = 0; i < NGROUPS; i++)
        if (n > 0 && cover(&groups[i], expected, n, covered))
            words[nwords++] = groups[i].name;
    for (int i = 0; i < n; i++)
        if (!covered[i])
            words[nwords++] = yysymbol_name(expected[i]);
    list[0] = '\0';
    for (int i = 0; i < nwords; i++)
        add_word(list, size, words[i], i == nwords - 1);
}

static int yyreport_syntax_error(const yypcontext_t *context, sg_parse *p, void *scanner)
{
    (void)scanner;
    char list[360], found[64];
    list_expected(context, list, sizeof list);
    const sg_pos at = *yypcontext_location(context);
    const yysymbol_kind_t token = yypcontext_token(context);
    if (token == YYSYMBOL_YYEOF)
        snprintf(found, sizeof found, "the end of the file");
    else /* the scanner stands behind the token that it gave last */
        snprintf(found, sizeof found, "'%.*s'", (int)(p->at.offset - at.offset), p->source.text + at.offset);
    sg_parse_fail(p, at, "found %s; expected %s", found, list[0] != '\0' ? list : "something else");
    return 0;
}
