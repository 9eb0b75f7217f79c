#!/usr/bin/env perl
# Looks for includes of which a file uses nothing: neither a name that a header of the project
# declares, nor, of another header, what the table below has for it. It knows text, not C++: a file
# that merely shares a name with a header is not found out, and a use that the table does not know
# is reported (then the table is wrong).
# Usage: check_unused_includes.pl [ROOT OF THE REPOSITORY]. Prints PATH:LINE: what is wrong, exits 1.
use strict;
use warnings;
use File::Find;
use File::Spec::Functions qw(catdir);
use FindBin;

my @folders = qw(assets common cw2 cw2-bake docs mesh-format packaging shaders tests);

# header | a pattern that whoever needs it matches. Every standard header in use must be here.
my %uses = map { /^\s*(\S+)\s*\|\s*(.+?)\s*$/ ? ($1 => qr/\b(?:$2)/) : () } split /\n/, <<'TABLE';
algorithm       | std::(?:ranges::)?(?:max|min|minmax|clamp|m(?:ax|in|inmax)_element|fill|copy|move|transform|generate|swap_ranges|all_of|any_of|none_of|for_each|count|find|search|adjacent_find|mismatch|equal|sort|stable_sort|partial_sort|nth_element|is_sorted|lower_bound|upper_bound|equal_range|binary_search|merge|includes|set_\w+|\w*_heap|lexicographical_compare|\w*permutation|remove|replace|reverse|rotate|unique|partition|stable_partition|partition_point|shuffle|sample|shift_left|shift_right|starts_with|contains)(?:_if|_if_not|_n|_copy|_copy_if|_backward|_first_of|_end|_until)?\b
array           | std::(?:array|to_array|tuple_size)\b
atomic          | std::(?:atomic|memory_order)
bit             | std::(?:bit_|has_single_bit|countl_|countr_|popcount|rotl|rotr|endian)
cassert         | assert\s*\(
cctype          | (?:is(?:alnum|alpha|digit|space|upper|lower|print|xdigit|punct)|to(?:upper|lower))\b
cerrno          | errno\b
cfloat          | (?:FLT|DBL)_\w+
charconv        | (?:from_chars|to_chars|chars_format)
chrono          | std::chrono|steady_clock
clocale         | (?:setlocale|localeconv|newlocale|uselocale|lconv|LC_\w+)\b
cmath           | (?:abs|fabs|sqrt|cbrt|hypot|pow|exp2?|expm1|log(?:2|10|1p|b)?|ilogb|ldexp|scalbn|frexp|modf|a?sinh?|a?cosh?|a?tanh?|atan2|floor|ceil|round|l?l?round|nearbyint|l?l?rint|trunc|fmod|remainder|fmax|fmin|fma|isnan|isfinite|isinf|signbit|copysign|nextafter|nexttoward|nan|lerp|HUGE_VAL|NAN|INFINITY|M_PI|erfc?|tgamma|lgamma)f?\b
compare         | (?:(?:strong|weak|partial)_ordering)|.*<=>
condition_variable | std::condition_variable
climits         | (?:[A-Z]+_(?:MAX|MIN|BIT))\b
csetjmp         | (?:setjmp|longjmp|jmp_buf)
csignal         | (?:raise|signal|SIG[A-Z]+)\b
cstddef         | (?:size_t|ptrdiff_t|byte|to_integer|offsetof|nullptr_t|max_align_t|NULL)\b
cstdint         | (?:u?int(?:_fast|_least)?(?:8|16|32|64|ptr|max)_t|U?INT\d+_(?:MAX|MIN|C)|SIZE_MAX)\b
cstdarg         | va_(?:list|start|arg|end|copy)\b
cstdio          | (?:[fs]?n?printf|f?puts|f?putc|fputs|putchar|fopen|fclose|fread|fwrite|fseek|ftell|fflush|setvbuf|remove|rename|tmpfile|fileno|rewind|perror|FILE|stdout|stderr|stdin|EOF)\b
cstdlib         | (?:getenv|setenv|putenv|exit|_Exit|quick_exit|abort|strto\w+|ato[ifl]|malloc|calloc|realloc|free|aligned_alloc|system|EXIT_\w+|div|rand|qsort|mkdtemp|realpath)\b
cstring         | (?:mem(?:cpy|cmp|set|move|chr)|str(?:len|n?cmp|n?cpy|r?chr|str|error|n?cat|spn|cspn))\b
ctime           | (?:clock|time|clock_t|time_t|CLOCKS_PER_SEC)\b
deque           | std::deque\b
exception       | std::(?:exception|current_exception|rethrow_exception|make_exception_ptr|terminate|uncaught_exceptions)
filesystem      | (?:std::)?filesystem\b
fnmatch.h       | (?:fnmatch|FNM_\w+)
forward_list    | std::forward_list\b
fstream         | std::[io]?fstream\b
functional      | std::(?:function|hash|less|greater|equal_to|plus|multiplies|minus|bind|ref|cref|invoke|identity|mem_fn|reference_wrapper|not_fn|bit_\w+|logical_\w+)\b
future          | std::(?:future|async|promise|packaged_task|launch)\b
iostream        | std::(?:cout|cerr|cin|clog)\b
iterator        | std::(?:(?:istreambuf|istream|ostream|ostreambuf|reverse|move|insert|back_insert)_iterator|back_inserter|inserter|next|prev|advance|distance|size|ssize|data|begin|end|make_move_iterator|iterator_traits|\w+_iterator|empty)\b
limits          | std::numeric_limits
list            | std::list\b
map             | std::(?:multi)?map\b
memory          | std::(?:unique_ptr|shared_ptr|weak_ptr|make_unique|make_shared|allocator|addressof|enable_shared_from_this|construct_at|destroy\w*|uninitialized_\w+|to_address|assume_aligned|align|pmr)
mutex           | std::(?:mutex|\w*lock\w*|recursive_mutex|call_once|once_flag)\b
new             | std::(?:bad_alloc|nothrow|launder|align_val_t|hardware_\w+|bad_array_new_length)|.*\bnew\s*\(
numbers         | std::numbers
numeric         | std::(?:accumulate|iota|reduce|inner_product|partial_sum|adjacent_difference|transform_reduce|\w+_scan|gcd|lcm|midpoint)\b
optional        | std::(?:optional|nullopt|make_optional)
queue           | std::(?:priority_)?queue\b
random          | std::(?:\w+_distribution|mt19937\w*|minstd_rand0?|default_random_engine|random_device|seed_seq|philox\w*)
set             | std::(?:multi)?set\b
span            | std::(?:span|as_bytes|as_writable_bytes|dynamic_extent)\b
sstream         | std::[io]?stringstream\b
stdexcept       | std::(?:runtime_error|logic_error|invalid_argument|out_of_range|domain_error|length_error|range_error|overflow_error|underflow_error)
string          | std::(?:string|to_string|sto\w+|getline|char_traits|u8string|string_literals|basic_string)\b
string_view     | (?:std::)?(?:string_view|basic_string_view|string_view_literals)\b|.*"sv\b
system_error    | std::(?:error_code|error_category|system_error|errc|generic_category|system_category|make_error_code)
thread          | std::(?:j?thread|this_thread)\b
tuple           | std::(?:tuple|tie|make_tuple|forward_as_tuple|apply|ignore|get|tuple_cat|tuple_size\w*|tuple_element\w*)\b
type_traits     | std::(?:is_\w+|remove_\w+|add_\w+|decay\w*|conditional\w*|enable_if\w*|underlying_type\w*|common_type\w*|make_(?:un)?signed\w*|true_type|false_type|integral_constant|void_t|has_unique_object_representations\w*|invoke_result\w*|type_identity\w*|extent\w*)
unordered_map   | std::unordered_(?:multi)?map\b
unordered_set   | std::unordered_(?:multi)?set\b
utility         | std::(?:move|pair|make_pair|swap|exchange|forward|declval|index_sequence\w*|make_index_sequence|integer_sequence|in_range|cmp_\w+|as_const|piecewise_construct|in_place\w*|get|unreachable|to_underlying)\b
vector          | std::vector\b
CLI/CLI.hpp     | CLI::
dlfcn.h         | (?:dlopen|dlsym|dlclose|dlerror|RTLD_)
emmintrin.h     | (?:_mm_|__m128)
fast_float/fast_float.h | fast_float::
dirent.h        | (?:(?:open|read|close)dir|dirfd|dirent|DIR)\b
fcntl.h         | (?:open|openat|fcntl|posix_fadvise|O_[A-Z]+)\b
fmt/format.h    | (?:fmt::|FMT_)
GLFW/glfw3.h    | (?:glfw|GLFW)
glm/common.hpp  | glm::(?:min|max|abs|mix|clamp|floor|ceil|round|fract|sign|step|smoothstep|mod|isnan|isinf|trunc)\b
glm/geometric.hpp | glm::(?:dot|cross|length|normalize|distance|reflect|refract|faceforward)\b
glm/mat3x3.hpp  | d?mat3\b
glm/mat4x4.hpp  | d?mat4\b
glm/matrix.hpp  | glm::(?:transpose|inverse|determinant|outerProduct)\b
glm/trigonometric.hpp | glm::(?:radians|degrees|a?sin|a?cos|a?tan)\b
glm/vec2.hpp    | (?:[diub]|[iu](?:8|16|32|64)|f64)?vec2\b
glm/vec3.hpp    | (?:[diub]|[iu](?:8|16|32|64)|f64)?vec3\b
glm/vec4.hpp    | (?:[diub]|[iu](?:8|16|32|64)|f64)?vec4\b
glm/gtc/constants.hpp | glm::(?:pi|two_pi|half_pi|epsilon|root_two|golden_ratio)\b
glm/gtc/matrix_access.hpp | glm::(?:row|column)\b
glm/gtc/matrix_transform.hpp | glm::(?:translate|rotate|scale|perspective\w*|ortho\w*|frustum\w*|lookAt\w*|infinitePerspective\w*)\b
glm/gtc/quaternion.hpp | glm::(?:d?quat|\w+_cast|angleAxis|slerp)\b
glm/gtc/type_ptr.hpp | glm::(?:value_ptr|make_\w+)\b
gtest/gtest.h   | (?:TEST(?:_F|_P)?\b|testing::|(?:EXPECT|ASSERT)_|SCOPED_TRACE|ADD_FAILURE|FAIL\b)
imgui.h         | (?:ImGui|Im[A-Z]\w+)
jpeglib.h       | (?:jpeg_|j_\w+_ptr|JPEG_|JCS_|JDCT_)
meshoptimizer.h | meshopt_
nlohmann/json.hpp | (?:nlohmann::|NLOHMANN_)
OpenImageIO/imageio.h | (?:OIIO::|OIIO_)
png.h           | (?:png_|PNG_)
sched.h         | (?:sched_|CPU_|cpu_set_t)
sys/mman.h      | (?:mmap|munmap|madvise|memfd_create|MAP_|PROT_|MADV_|MFD_)
sys/resource.h  | (?:getrusage|rusage|setrlimit|getrlimit|rlimit|RLIMIT_)
sys/stat.h      | (?:f?stat|lstat|mkdir|umask|f?chmod|S_I\w+|futimens|utimensat|mkfifo)\b
sys/wait.h      | (?:waitpid|wait4|WIF\w+|WEXITSTATUS)\b
tbb/blocked_range.h | tbb::blocked_range
tbb/concurrent_queue.h | tbb::concurrent_\w*queue
tbb/enumerable_thread_specific.h | tbb::(?:enumerable_thread_specific|combinable)
tbb/global_control.h | tbb::global_control
tbb/parallel_for.h | tbb::parallel_for
tbb/parallel_invoke.h | tbb::parallel_invoke
tbb/parallel_reduce.h | tbb::parallel_reduce
tbb/parallel_pipeline.h | tbb::(?:parallel_pipeline|make_filter|flow_control|filter)
tiny_gltf.h     | (?:tinygltf::|TINYGLTF_)
tiny_obj_loader.h | tinyobj::
toml++/toml.h   | toml::
unistd.h        | (?:read|write|close|fork|exec\w+|_exit|dup2?|pipe|unlink|getpid|isatty|sysconf|ftruncate|access|chdir|fsync|pread|pwrite|usleep|sleep|lseek|mkdtemp|link|ssize_t|_SC_\w+|STD(?:IN|OUT|ERR)_FILENO)\b
vulkan/vulkan.h | (?:Vk[A-Z]|vk[A-Z]|VK_)
xxhash.h        | (?:XXH|xxh)
zstd.h          | ZSTD_
TABLE

my %text;  # of files without comments and strings' contents

sub text_of {
    my ($path) = @_;
    return $text{$path} //= do {
        open my $file, '<', $path or die "$path: $!\n";
        local $/;
        my $all = <$file>;
        # Comments and what strings say go; includes and line breaks stay.
        $all =~ s{(^[ \t]*\#[ \t]*include[^\n]*)|//[^\n]*|/\*.*?\*/|R"\((.*?)\)"|"(?:\\.|[^"\\\n])*"|(?<![0-9a-fA-F])'(?:\\.|[^'\\\n])'}
                 {defined $1 ? $1 : do { my $gone = $&; my $lines = $gone =~ tr/\n//;
                    ($gone =~ /^["R]/ ? '""' : ' ') . "\n" x $lines }}gemsx;
        $all;
    };
}

# What a header declares: (names anyone may write, names that follow a dot or an arrow).
sub declared {
    my ($text) = @_;
    my (%free, %member);
    $free{$_} = 1 for $text =~ /^[ \t]*#[ \t]*define[ \t]+(\w+)/gm;
    $text =~ s/^[ \t]*#(?:[^\n\\]|\\.)*(?:\\\n[^\n]*)*//gm;
    # Bodies of functions declare nothing.
    my $braces;
    $braces = qr/\{(?:[^{}]++|(??{$braces}))*\}/;
    $text =~ s/(\)\s*(?:const\b|noexcept\b|override\b|final\b|mutable\b|&|->\s*[\w:<>,&* ]+|:\s*\w+[^;{}]*?[)}]|\s)*)$braces/$1;/g;
    for ($text =~ /\benum\b[^{;]*\{([^}]*)\}/g) { $free{$_} = 1 for /(\w+)\s*(?:=[^,]*)?(?:,|$)/g }
    $free{$_} = 1 for $text =~ /\b(?:enum\s+class|enum\s+struct|struct|class|union|concept|enum)\s+(?:\[\[.*?\]\]\s*)?(?!class\b|struct\b)(\w+)/g;
    $free{$_} = 1 for $text =~ /\b(?:using|namespace)\s+(\w+)\s*(?:\[\[.*?\]\]\s*)?=/g;
    $free{$_} = 1 for $text =~ /\btypedef\s[^;]*?(\w+)\s*(?:__attribute__[^;]*)?;/g;
    $free{$_} = 1 for $text =~ /\busing\s+[\w:]+::(\w+)\s*;/g;
    $free{$_} = 1 for $text =~ /[\w>&*\]]\s+[&*]*(operator\s*\S+|\w+)\s*\(/g;
    $free{$_} = 1 for $text =~ /\b(k[A-Z]\w*)\b\s*[={\[;]/g;
    $free{$_} = 1 for $text =~ /\bconst(?:expr)?\s+[\w:<>, ]+?\s(\w+)\s*[={\[]/g;
    $member{$_} = 1 for $text =~ /(\w+)\s*(?:=[^,;{}]*|\{[^{}]*\}|\[[^\]]*\])?\s*[;,]/g;
    return (\%free, \%member);
}

my %declared;

sub uses_of_project {
    my ($text, $header) = @_;
    my ($free, $member) = @{$declared{$header} //= [declared(text_of($header))]};
    return 1 if !%$free && !%$member;
    while ($text =~ /(\.|->)?\s*\b([A-Za-z_]\w*)/g) {
        return 1 if $free->{$2} || (defined $1 && $member->{$2});
    }
    return $text =~ /[<>=!]=|[-+*\/|&^]/ && grep /^operator/, keys %$free;
}

chdir($ARGV[0] // catdir($FindBin::Bin, '..')) or die "$!\n";
my @files;
find({no_chdir => 1, wanted => sub { push @files, $_ if /\.(?:cpp|h)$/ && -f }},
     grep { -d } @folders);
my $status = 0;
sub complain { print "@_\n"; $status = 1 }

for my $path (sort @files) {
    my $text = text_of($path);
    (my $body = $text) =~ s/^[ \t]*#[ \t]*include[^\n]*//gm;
    (my $stem = $path) =~ s/\.\w+$//;
    my ($folder) = $path =~ m{(.*)/};
    my ($line, %seen) = (0);
    for (split /\n/, $text) {
        ++$line;
        my ($quote, $header) = /^[ \t]*#[ \t]*include[ \t]*(["<])([^">]+)/ or next;
        complain("$path:$line: includes $header twice") if $seen{$header}++;
        if ($quote eq '<') {
            if (my $use = $uses{$header}) {
                complain("$path:$line: uses nothing of $header") if $body !~ /$use/;
            } elsif ($header =~ /^[a-z_]+$/) {
                complain("$path:$line: check_unused_includes.pl does not know $header");
            }
            next;
        }
        my ($file) = grep { -f } ($header, "$folder/$header") or next;  # a generated one
        next if $file eq "$stem.h";
        complain("$path:$line: uses nothing of $header") if !uses_of_project($body, $file);
    }
}
exit $status;
