// The contents: a link to each section, the one in view marked.
(() => {
  const list = document.querySelector('nav ul');
  const sections = [...document.querySelectorAll('section')];
  const many = document.querySelectorAll('article').length > 1;
  const links = new Map();
  for (const section of sections) {
    const heading = section.querySelector('h2, h3');
    const number = section.closest('article')?.id.replace('run-', '');
    const link = dea.element('a', { href: '#' + section.id }, (many && number ? number + ' ' : '') + heading.textContent);
    list.append(dea.element('li', {}, link));
    links.set(section, link);
  }
  const seen = new IntersectionObserver((entries) => {
    for (const entry of entries) {
      if (entry.isIntersecting) {
        for (const link of links.values()) {
          link.removeAttribute('aria-current');
        }
        links.get(entry.target).setAttribute('aria-current', 'true');
      }
    }
  }, { rootMargin: '-20% 0px -70% 0px' });
  sections.forEach((section) => seen.observe(section));
})();
