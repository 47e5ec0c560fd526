function dea_build(varargin)
  % Compiles dea_mex.c for this Octave or MATLAB; once, and again after an update of either.
  %
  %   dea_build()
  %   dea_build('include', DIR, 'library', DIR, 'to', DIR)
  %
  % include, library: folders of dea.h and of libdea; without them pkg-config is asked.
  % to: where the MEX file goes; without it beside this file. Another folder has to be on the path.
  here = fileparts(mfilename('fullpath'));
  o = dea.options(struct('include', '', 'library', '', 'to', here), varargin);
  if isempty(o.include)
    o.include = ask('--variable=includedir');
  end
  if isempty(o.library)
    o.library = ask('--variable=libdir');
  end
  arguments = {fullfile(here, 'dea_mex.c'), ['-I' o.include], ['-L' o.library], '-ldea'};
  if exist('OCTAVE_VERSION', 'builtin')
    target = fullfile(o.to, 'dea_mex.mex');
    mkoctfile('--mex', '-o', target, arguments{:}, ['-Wl,-rpath,' o.library]);
  else
    target = fullfile(o.to, ['dea_mex.' mexext]);
    arguments = [arguments, {'-outdir', o.to, ['LDFLAGS=$LDFLAGS -Wl,-rpath,' o.library]}];
    try
      mex(arguments{:}, '-DDEA_HAVE_UT', '-lut'); % so that Ctrl-C stops a run
    catch
      mex(arguments{:});
    end
  end
  if ~exist(target, 'file')
    error('dea:build', '%s was not made', target);
  end
end

function answer = ask(what)
  [status, answer] = system(['pkg-config ' what ' libdea']);
  answer = strtrim(answer);
  if status ~= 0
    error('dea:build', 'pkg-config does not know libdea: give ''include'' and ''library''');
  end
end
